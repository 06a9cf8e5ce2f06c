"""Flight control of tail-sitters from hover to cruise and back, at any angle of attack.

SI units; names end in their unit. Vectors are (north, east, down). The vertical plane is the one to the north: east is 0 there.
Its theta is 0 in hover, nose up, and -pi/2 in level cruise.
"""

from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Literal, TypedDict, final

from numpy.typing import ArrayLike, NDArray

__version__: str

_Source = str | PathLike[str]
_Set = Mapping[str, Any] | Iterable[str]
_Axes = Literal["nose-forward", "nose-up"]

class _Parameter(TypedDict):
    name: str
    unit: str
    least: float
    most: float
    default: float | None
    meaning: str

class FieldError(ValueError):
    """A parameter, a field or an argument that is refused."""

    field: str
    problem: str

class Fault(ValueError):
    """A law has no command for its inputs."""

    name: str

@final
class Frame:
    """Columns of equal length by name, each in one buffer of memory."""

    @property
    def names(self) -> list[str]: ...
    def __len__(self) -> int: ...
    def __contains__(self, name: str, /) -> bool: ...
    def __getitem__(self, name: str, /) -> NDArray[Any]: ...
    def numpy(self) -> dict[str, NDArray[Any]]: ...
    def pandas(self) -> Any: ...
    def arrow(self) -> Any: ...

@final
class Model:
    """Lift and drag coefficients over the angle of attack."""

    @staticmethod
    def large_angle(**parameters: float) -> Model: ...
    @staticmethod
    def small_angle(**parameters: float) -> Model: ...
    @staticmethod
    def combined(**parameters: float) -> Model: ...
    @staticmethod
    def table(alpha_deg: Iterable[float], cl: Iterable[float], cd: Iterable[float]) -> Model: ...
    @staticmethod
    def load(source: _Source) -> Model: ...
    @property
    def parameters(self) -> dict[str, float] | None: ...
    def coefficients(self, alpha_rad: ArrayLike) -> Frame: ...

@final
class Vehicle:
    """Mass, aerodynamic constant, thrust line, thrust limits and coefficients."""

    def __new__(cls, model: Model | None = None, **parameters: float) -> Vehicle: ...
    @staticmethod
    def load(source: _Source = ...) -> Vehicle: ...
    @property
    def name(self) -> str: ...
    @property
    def model(self) -> Model: ...
    @property
    def parameters(self) -> dict[str, float]: ...

@final
class Command:
    """Command of one step of a law."""

    @property
    def thrust_n(self) -> float: ...
    @property
    def rate_rad_s(self) -> float: ...
    @property
    def alpha_rad(self) -> float: ...
    @property
    def fp_n(self) -> float: ...
    @property
    def theta_tilde_rad(self) -> float: ...
    @property
    def t_p_n(self) -> float: ...
    @property
    def guard_alignment(self) -> float: ...
    @property
    def guard_feed_forward(self) -> float: ...
    @property
    def k(self) -> float: ...

@final
class Law:
    """One of the paper's velocity laws in the vertical plane."""

    def __new__(
        cls,
        vehicle: Vehicle,
        form: Literal["robust", "full"] = "robust",
        *,
        gains: dict[str, float] | None = None,
        bandwidth: dict[str, float] | None = None,
    ) -> Law: ...
    def command(
        self,
        velocity: ArrayLike,
        theta: float,
        reference_velocity: ArrayLike,
        reference_acceleration: ArrayLike | None = None,
        wind: ArrayLike | None = None,
        *,
        air_acceleration: ArrayLike | None = None,
        jerk: ArrayLike | None = None,
    ) -> Command: ...
    def commands(
        self,
        velocity: ArrayLike,
        theta: ArrayLike,
        reference_velocity: ArrayLike,
        reference_acceleration: ArrayLike | None = None,
        wind: ArrayLike | None = None,
    ) -> Frame: ...

@final
class GuidanceOutput:
    """What a step of the guidance gives: always a command."""

    @property
    def thrust_n(self) -> float: ...
    @property
    def rates_rad_s(self) -> list[float]: ...
    @property
    def rate_rad_s(self) -> float: ...
    @property
    def mode(self) -> Literal["safe", "holding", "flying"]: ...
    @property
    def air(self) -> Literal["velocity", "wind", "pitot", "held-wind", "none"]: ...
    @property
    def status(self) -> list[str]: ...
    @property
    def reject_reason(self) -> str | None: ...
    @property
    def phase(self) -> Literal["tracking", "crossing", "coasting", "recovering"]: ...
    @property
    def unreachable(self) -> Literal["sink", "speed", "thrust"] | None: ...
    @property
    def margin_force(self) -> float: ...
    @property
    def margin_k(self) -> float: ...
    @property
    def margin_fold_rad(self) -> float: ...
    @property
    def reference_velocity_m_s(self) -> list[float]: ...
    @property
    def reference_acceleration_m_s2(self) -> list[float]: ...

@final
class Guidance:
    """The law with everything around it that a real vehicle asks for.

    Its parameters by keyword, as `parameters()` names them; those left out are at their defaults. With
    `for_vehicle={"rate_lag_s": …, "thrust_lag_s": …, "cruise_speed_m_s": …, "control_rate_hz": 100}` they follow by the rules of the library instead.
    """

    def __new__(cls, vehicle: Vehicle, **parameters: Any) -> Guidance: ...
    @property
    def parameters(self) -> dict[str, float]: ...
    @property
    def state(self) -> bytes: ...
    @state.setter
    def state(self, state: bytes) -> None: ...
    def reset(self) -> None: ...
    def update(
        self,
        dt: float,
        *,
        velocity: ArrayLike,
        quaternion: ArrayLike,
        reference_velocity: ArrayLike,
        reference_acceleration: ArrayLike | None = None,
        heading: float | None = None,
        air_velocity: ArrayLike | None = None,
        wind: ArrayLike | None = None,
        airspeed: float | None = None,
        specific_force: ArrayLike | None = None,
        position_error: ArrayLike | None = None,
        state_age: float = 0.0,
        reference_age: float = 0.0,
        axes: _Axes = "nose-forward",
        altitude_band: float = 0.0,
        nose_below_vertical: bool = False,
        hold_altitude_only: bool = False,
    ) -> GuidanceOutput: ...
    def update_in_plane(
        self,
        dt: float,
        *,
        velocity: ArrayLike,
        theta: float,
        reference_velocity: ArrayLike,
        reference_acceleration: ArrayLike | None = None,
        air_velocity: ArrayLike | None = None,
        wind: ArrayLike | None = None,
        airspeed: float | None = None,
        specific_force: ArrayLike | None = None,
        position_error: ArrayLike | None = None,
        state_age: float = 0.0,
        reference_age: float = 0.0,
        altitude_band: float = 0.0,
        nose_below_vertical: bool = False,
        hold_altitude_only: bool = False,
    ) -> GuidanceOutput: ...

@final
class Fleet:
    """`n` vehicles of one kind, each under a `Guidance` of its own with the same parameters."""

    def __new__(cls, vehicle: Vehicle, n: int, **parameters: Any) -> Fleet: ...
    def __len__(self) -> int: ...
    def reset(self) -> None: ...
    def update(
        self,
        dt: float,
        *,
        velocity: ArrayLike,
        quaternion: ArrayLike,
        reference_velocity: ArrayLike,
        reference_acceleration: ArrayLike | None = None,
        heading: ArrayLike | None = None,
        air_velocity: ArrayLike | None = None,
        wind: ArrayLike | None = None,
        specific_force: ArrayLike | None = None,
        position_error: ArrayLike | None = None,
        axes: _Axes = "nose-forward",
    ) -> Frame: ...

class _Asked(TypedDict):
    reference_velocity: list[float]
    reference_acceleration: list[float]
    heading: float | None
    position_error: list[float]
    altitude_band: float
    nose_below_vertical: bool
    hold_altitude_only: bool

@final
class Goals:
    """Makes, step by step, the reference that the guidance takes, of something that is to be reached."""

    def __new__(
        cls,
        speed_m_s: float = 20.0,
        climb_m_s: float = 3.0,
        acceleration_m_s2: float = 2.0,
        *,
        braking_climb_m: float = 0.0,
        altitude_band_m: float = 0.0,
        nose_below_vertical: bool = False,
    ) -> Goals: ...
    def hover(self, place: ArrayLike) -> None: ...
    def stop(self) -> None: ...
    def fly(self, velocity: ArrayLike) -> None: ...
    @property
    def reached(self) -> bool: ...
    def reset(self) -> None: ...
    def step(self, dt: float, *, position: ArrayLike, velocity: ArrayLike) -> _Asked: ...

@final
class MissionOutput:
    """What a step of a mission says."""

    @property
    def asked(self) -> _Asked: ...
    @property
    def gate(self) -> Literal["off", "at-most", "open"]: ...
    @property
    def activity(self) -> Literal["grounded", "spooling", "rising", "flying", "hovering", "descending", "touched"]: ...
    @property
    def item(self) -> int: ...
    @property
    def remark(self) -> str | None: ...
    @property
    def troubles(self) -> list[str]: ...
    @property
    def response(self) -> Literal["continue", "loiter", "return", "land"]: ...
    @property
    def distance_to_go_m(self) -> float: ...
    @property
    def time_to_go_s(self) -> float: ...
    @property
    def airspeed_m_s(self) -> float: ...
    @property
    def right_m(self) -> float: ...
    @property
    def energy_j(self) -> float: ...
    @property
    def most_thrust_n(self) -> float | None: ...
    def passed(self, thrust_n: float, rates_rad_s: Sequence[float]) -> tuple[float, list[float]]: ...

@final
class Mission:
    """A list of things to fly, checked against a vehicle, and how far it has come."""

    def __new__(
        cls, vehicle: Vehicle, items: Sequence[Mapping[str, Any] | str], *, responses: dict[str, str] | None = None, **parameters: float
    ) -> Mission: ...
    @staticmethod
    def load(source: _Source, vehicle: Vehicle, **parameters: float) -> Mission: ...
    @property
    def items(self) -> list[dict[str, Any] | str]: ...
    @property
    def speeds_m_s(self) -> list[float]: ...
    @property
    def done(self) -> bool: ...
    def go_to(self, item: int) -> None: ...
    def reset(self) -> None: ...
    def step(
        self,
        dt: float,
        *,
        velocity: ArrayLike,
        quaternion: ArrayLike,
        position: ArrayLike | None = None,
        wind: ArrayLike | None = None,
        airspeed: float | None = None,
        thrust_n: float = 0.0,
        armed: bool = True,
        troubles: Sequence[str] = ...,
        axes: _Axes = "nose-forward",
    ) -> MissionOutput: ...
    def __len__(self) -> int: ...

@final
class Equilibrium:
    """An orientation that holds a reference."""

    @property
    def theta_rad(self) -> float: ...
    @property
    def alpha_rad(self) -> float: ...
    @property
    def thrust_n(self) -> float: ...
    @property
    def t_p_n(self) -> float: ...
    @property
    def fp_n(self) -> float: ...
    @property
    def branch(self) -> Literal["0", "pi"]: ...
    @property
    def isolated(self) -> bool: ...
    @property
    def fold_alpha_rad(self) -> float | None: ...
    @property
    def fold_speed_ratio(self) -> float | None: ...

@final
class Envelope:
    """Equilibria over the airspeed, in double precision."""

    @property
    def summary(self) -> dict[str, Any]: ...
    @property
    def curve(self) -> Frame: ...

@final
class Experiment:
    """A flight to be flown."""

    def __new__(cls, source: _Source = ..., set: _Set | None = None, *, vehicle: _Source | None = None) -> Experiment: ...
    @staticmethod
    def from_toml(text: str, name: str = "experiment", set: _Set | None = None) -> Experiment: ...
    @property
    def name(self) -> str: ...
    @property
    def toml(self) -> str: ...
    def get(self, path: str) -> Any: ...
    def fly(self) -> Flight: ...

@final
class Beyond:
    """A figure that does not keep its bound."""

    @property
    def figure(self) -> str: ...
    @property
    def value(self) -> float: ...
    @property
    def bound(self) -> float: ...

@final
class Flight:
    """A flight that has been flown."""

    @property
    def name(self) -> str: ...
    @property
    def figures(self) -> dict[str, Any]: ...
    @property
    def segments(self) -> list[dict[str, Any]]: ...
    @property
    def record(self) -> Frame: ...
    @property
    def beyond(self) -> list[Beyond]: ...

@final
class Moment:
    """What there is at a step of a simulation."""

    @property
    def time_s(self) -> float: ...
    @property
    def position_m(self) -> list[float]: ...
    @property
    def velocity_m_s(self) -> list[float]: ...
    @property
    def quaternion(self) -> list[float]: ...
    @property
    def rates_rad_s(self) -> list[float]: ...
    @property
    def thrust_n(self) -> float: ...
    @property
    def wind_m_s(self) -> list[float]: ...
    @property
    def reference_position_m(self) -> list[float]: ...
    @property
    def reference_velocity_m_s(self) -> list[float]: ...
    @property
    def reference_acceleration_m_s2(self) -> list[float]: ...
    @property
    def answer_thrust_n(self) -> float: ...
    @property
    def answer_rates_rad_s(self) -> list[float]: ...
    @property
    def mode(self) -> Literal["safe", "holding", "flying"] | None: ...

@final
class Simulation:
    """An experiment that is flown step by step, at its own rate."""

    def __new__(cls, source: Experiment | _Source, set: _Set | None = None) -> Simulation: ...
    def reset(self, seed: int | None = None) -> None: ...
    @property
    def now(self) -> Moment: ...
    def step(self, thrust_n: float | None = None, rates_rad_s: ArrayLike | None = None) -> Moment: ...
    @property
    def name(self) -> str: ...
    @property
    def period_s(self) -> float: ...
    @property
    def duration_s(self) -> float: ...
    @property
    def sound(self) -> bool: ...
    @property
    def weight_n(self) -> float: ...
    @property
    def thrust_limits_n(self) -> list[float]: ...

@final
class Design:
    """A vehicle of one's own, made by `new`, with what its first flight came to."""

    @property
    def name(self) -> str: ...
    @property
    def vehicle(self) -> Vehicle: ...
    @property
    def parameters(self) -> dict[str, float]: ...
    @property
    def experiment(self) -> Experiment: ...
    @property
    def flight(self) -> Flight: ...
    @property
    def outcome(self) -> Literal["as-asked", "outside-goals", "fails"]: ...
    @property
    def verdict(self) -> str: ...
    @property
    def story(self) -> list[str]: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def performance(self) -> dict[str, Any]: ...
    @property
    def margins(self) -> list[dict[str, Any]]: ...
    @property
    def files(self) -> dict[str, str]: ...
    def write(self, folder: _Source, *, force: bool = False) -> Path: ...

@final
class Campaign:
    """A campaign that has been flown."""

    @property
    def name(self) -> str: ...
    @property
    def passed(self) -> bool: ...
    @property
    def summary(self) -> Any: ...
    @property
    def flights(self) -> Frame: ...
    @property
    def samples(self) -> Frame: ...
    def refly(self, number: int) -> Flight: ...

@final
class Replay:
    """A controller run over a logged flight."""

    @property
    def record(self) -> Frame: ...
    @property
    def notes(self) -> list[str]: ...

def new(name: str = "my-vehicle", **known: float | str) -> Design: ...
def parameters() -> dict[str, list[_Parameter]]: ...
def polars() -> list[str]: ...
def experiments() -> dict[str, str]: ...
def campaigns() -> dict[str, str]: ...
def equilibria(
    vehicle: Vehicle | _Source,
    velocity: ArrayLike,
    acceleration: ArrayLike | None = None,
    wind: ArrayLike | None = None,
) -> list[Equilibrium]: ...
def envelope(
    vehicle: Vehicle | _Source, *, climb_deg: float | None = None, accel: float | None = None
) -> Envelope: ...
def fly(source: _Source = ..., set: _Set | None = None) -> Flight: ...
def replay(
    file: _Source,
    source: _Source = ...,
    set: _Set | None = None,
    *,
    map: _Source | None = None,
) -> Replay: ...
def campaign(
    source: _Source,
    flights: int | None = None,
    *,
    threads: int | None = None,
) -> Campaign: ...
def margins(
    source: _Source = ...,
    set: _Set | None = None,
    *,
    speeds: Sequence[float] | None = None,
    belief: bool = False,
    bare: bool = False,
) -> list[dict[str, Any]]: ...
def sweep(
    source: _Source = ..., set: _Set | None = None, *, min_fp_n: float | None = None
) -> dict[str, Any]: ...
def compare(source: _Source = ..., *, threads: int | None = None) -> Frame: ...
