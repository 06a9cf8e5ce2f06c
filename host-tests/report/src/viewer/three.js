export { WebGLRenderer, Scene, PerspectiveCamera, Group, Mesh, Line, LineLoop, LineSegments, BufferGeometry, BufferAttribute, Float32BufferAttribute,
  MeshLambertMaterial, MeshBasicMaterial, LineBasicMaterial, LineDashedMaterial, HemisphereLight, DirectionalLight, ArrowHelper, GridHelper, Vector3, Quaternion, Matrix4, Color, Fog, DoubleSide,
  CylinderGeometry, ConeGeometry, BoxGeometry, CircleGeometry, PlaneGeometry } from "three";
export { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
