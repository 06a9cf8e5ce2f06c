//! Missions as ground stations write them: QGroundControl's `.plan` files, made of MAVLink mission items.
//!
//! <https://docs.qgroundcontrol.com/master/en/qgc-dev-user-guide/file_formats/plan.html>,
//! <https://mavlink.io/en/messages/common.html#mav_commands>. What a mission here does not have is refused by the number of the item and the field; what
//! does not move the vehicle, as a camera's trigger, is left out and said.

use std::path::Path;

use alula::mission::Item;
use serde_json::Value as Json;
use toml::{Table, Value};

use super::document::{Document, FieldError, Located, read};
use super::mission::ItemSpec;
use crate::kind::Kind;
use crate::named::text_of;

/// A plan as the table `[mission]`, and what was left out of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The table.
    pub mission: Table,
    /// What was left out: item and command.
    pub left_out: Vec<String>,
    /// Length of its legs \[m\].
    pub length: f64,
}

/// Semi-axis \[m\] and squared eccentricity of WGS 84.
const AXIS: f64 = 6_378_137.0;
const ECCENTRICITY: f64 = 6.694_379_990_14e-3;

/// Frames of items: altitude over the sea, and over home.
const OVER_SEA: [i64; 2] = [0, 5];
const OVER_HOME: [i64; 2] = [3, 6];
/// The frame of items without a place.
const NO_PLACE: i64 = 2;

/// Commands that do not move the vehicle: mounts, cameras, servos, regions of interest, and a transition, which follows from the speed.
const LEFT_OUT: [i64; 17] = [
    93, 112, 183, 187, 189, 195, 197, 201, 203, 205, 206, 530, 532, 2000, 2001, 2500, 3000,
];

/// The place that positions are counted from: latitude and longitude \[°\], altitude over the sea \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Home(pub [f64; 3]);

impl Home {
    /// Metres a degree of latitude and of longitude.
    fn degrees(&self) -> [f64; 2] {
        let (sin, cos) = libm::sincos(self.0[0].to_radians());
        let w = (1.0 - ECCENTRICITY * sin * sin).sqrt();
        let meridian = AXIS * (1.0 - ECCENTRICITY) / w.powi(3);
        [meridian, AXIS / w * cos].map(f64::to_radians)
    }

    /// North and east \[m\] of a place.
    fn local(&self, latitude: f64, longitude: f64) -> [f64; 2] {
        let [lat, lon, _] = self.0;
        let [north, east] = self.degrees();
        [(latitude - lat) * north, (longitude - lon) * east]
    }

    /// Latitude and longitude \[°\], and altitude over the sea \[m\], of a place north, east and down \[m\].
    pub fn global(&self, [north, east, down]: [f64; 3]) -> [f64; 3] {
        let [lat, lon, alt] = self.0;
        let [a, b] = self.degrees();
        [lat + north / a, lon + east / b, alt - down]
    }
}

/// An item as MAVLink has it. What is null or NaN is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MavItem {
    /// `MAV_CMD`.
    pub command: i64,
    /// `MAV_FRAME`.
    pub frame: i64,
    /// Its seven parameters; of a place the last three are latitude and longitude \[°\] and altitude \[m\].
    pub params: [Option<f64>; 7],
}

/// The items of a mission, each with the number of the one in `items` that it is of: one may become two, and one that moves nothing none.
///
/// # Errors
/// The first that is not flown: its number, and what is wrong with which field.
pub fn items_flown(
    items: &[MavItem],
    home: Home,
) -> Result<Vec<(usize, Item)>, (usize, FieldError)> {
    let mut reader = Reader::new(home);
    let mut all = Vec::new();
    for (number, item) in items.iter().enumerate() {
        let refused = |e| (number, e);
        reader.command("", item, false).map_err(refused)?;
        for value in reader.items.drain(..) {
            let spec: ItemSpec = read(value).map_err(refused)?;
            let item = spec
                .item()
                .map_err(|(f, p)| (number, FieldError::new(f, p)))?;
            all.push((number, item));
        }
    }
    Ok(all)
}

/// An item on the way to the table.
struct Reader {
    home: Home,
    items: Vec<Value>,
    left_out: Vec<String>,
    /// The place flown to last \[m\], and the length so far.
    at: [f64; 2],
    length: f64,
}

fn refused(field: impl Into<String>, problem: impl Into<String>) -> FieldError {
    FieldError::new(field, problem)
}

fn entry(kind: &str, fields: &[(&str, f64)]) -> Value {
    let numbers = fields.iter().map(|(key, x)| ((*key).into(), (*x).into()));
    let inner = Value::Table(numbers.collect());
    Value::Table([(kind.to_owned(), inner)].into_iter().collect())
}

fn put(item: &mut Value, key: &str, value: impl Into<Value>) {
    if let Value::Table(table) = item
        && let Some(Value::Table(inner)) = table.iter_mut().next().map(|(_, inner)| inner)
    {
        inner.insert(key.into(), value.into());
    }
}

/// The experiment in which the vehicle of another, `vehicle`, flies the mission of the `.plan` file `file`; and what of that is left out.
///
/// # Errors
/// As [`plan`], with the file; a file or an experiment that cannot be read.
pub fn of_plan(file: &Path, vehicle: &str) -> anyhow::Result<(Document, Vec<String>)> {
    let origin = &file.display().to_string();
    let text = text_of(file)?;
    Kind::Plan.expect(origin, text.as_bytes())?;
    let plan = plan(&text).map_err(|error| Located {
        place: origin.clone(),
        error,
    })?;
    let mut document = Document::load(vehicle)?;
    let mut mission = plan.mission;
    let cruise = "controller.guidance.for_vehicle.cruise_speed_m_s";
    let cruise = document
        .number(cruise)
        .or_else(|_| document.number("plant.vehicle.cruise_speed_m_s"));
    if let Ok(cruise) = cruise {
        // The station's speed is its default for some vehicle; this one's own is known.
        mission.insert("cruise_speed_m_s".into(), cruise.into());
    }
    let speed = mission.get("cruise_speed_m_s").and_then(Value::as_float);
    document.change(origin, "mission", Value::Table(mission))?;
    document.change(origin, "initial", Value::Table(Table::new()))?;
    // Twice what the legs take, and time for take-off and landing.
    let duration = 120.0 + 2.0 * plan.length / speed.unwrap_or(10.0);
    document.change(origin, "duration_s", duration.ceil().into())?;
    let standing = document.get("plant.kind").and_then(Value::as_str) == Some("tail-sitter");
    if standing {
        document.change(origin, "plant.standing", true.into())?;
    }
    let stem = file.file_stem().map(|name| name.to_string_lossy());
    document.name = stem.unwrap_or_default().into_owned();
    Ok((document, plan.left_out))
}

/// Reads the text of a `.plan` file.
///
/// # Errors
/// The first thing that is no plan or cannot be flown, by item and field.
pub fn plan(text: &str) -> Result<Plan, FieldError> {
    let json: Json =
        serde_json::from_str(text).map_err(|e| refused("", format!("is no JSON: {e}")))?;
    let kind = json.get("fileType").and_then(Json::as_str);
    if kind != Some("Plan") {
        return Err(refused("fileType", "must be \"Plan\""));
    }
    let mission = json
        .get("mission")
        .ok_or_else(|| refused("mission", "is missing"))?;
    let home = mission.get("plannedHomePosition").and_then(Json::as_array);
    let home: Vec<f64> = home
        .into_iter()
        .flatten()
        .filter_map(Json::as_f64)
        .collect();
    let home: [f64; 3] = home.try_into().map_err(|_| {
        refused(
            "mission.plannedHomePosition",
            "must be [latitude, longitude, altitude]",
        )
    })?;
    if home[0].abs() > 89.0 || home[1].abs() > 360.0 {
        return Err(refused(
            "mission.plannedHomePosition",
            "is no place on earth",
        ));
    }
    let items = mission.get("items").and_then(Json::as_array);
    let items = items.ok_or_else(|| refused("mission.items", "is missing"))?;
    let mut reader = Reader::new(Home(home));
    for (number, item) in items.iter().enumerate() {
        reader.item(&format!("item {number}"), item, false)?;
    }
    let mut table = Table::new();
    if let Some(speed) = mission.get("cruiseSpeed").and_then(Json::as_f64) {
        table.insert("cruise_speed_m_s".into(), speed.into());
    }
    if let Some(speed) = mission.get("hoverSpeed").and_then(Json::as_f64) {
        table.insert("hover_speed_m_s".into(), speed.into());
    }
    table.insert("items".into(), reader.items.into());
    Ok(Plan {
        mission: table,
        left_out: reader.left_out,
        length: reader.length,
    })
}

impl MavItem {
    /// The item of a plan's JSON, which is called `name` where it is refused.
    fn of_json(name: &str, item: &Json) -> Result<Self, FieldError> {
        let at = |field: &str| format!("{name}: {field}");
        let command = item.get("command").and_then(Json::as_i64);
        let command = command.ok_or_else(|| refused(at("command"), "must be a number"))?;
        let params = item.get("params").and_then(Json::as_array);
        let params = params.map(|params| params.iter().map(Json::as_f64).collect::<Vec<_>>());
        let params = params.and_then(|params| params.try_into().ok());
        // Of those that are left out nobody asks.
        let params = match LEFT_OUT.contains(&command) {
            true => params.unwrap_or_default(),
            false => params.ok_or_else(|| refused(at("params"), "must be seven numbers"))?,
        };
        Ok(Self {
            command,
            frame: item.get("frame").and_then(Json::as_i64).unwrap_or(NO_PLACE),
            params,
        })
    }
}

impl Reader {
    fn new(home: Home) -> Self {
        Self {
            home,
            items: Vec::new(),
            left_out: Vec::new(),
            at: [0.0; 2],
            length: 0.0,
        }
    }

    /// An item of a plan; of a pattern its own items, whose waypoints are flown over.
    fn item(&mut self, name: &str, item: &Json, over: bool) -> Result<(), FieldError> {
        match item.get("type").and_then(Json::as_str) {
            Some("SimpleItem") => {
                let item = MavItem::of_json(name, item)?;
                self.command(&format!("{name}: "), &item, over)
            }
            Some("ComplexItem") => {
                let style = item.get("TransectStyleComplexItem").unwrap_or(item);
                let inner = style.get("Items").or_else(|| item.get("Items"));
                let Some(inner) = inner.and_then(Json::as_array) else {
                    let kind = item.get("complexItemType").and_then(Json::as_str);
                    let problem = format!("{} has no items of its own", kind.unwrap_or("?"));
                    return Err(refused(format!("{name}: complexItemType"), problem));
                };
                for (number, item) in inner.iter().enumerate() {
                    self.item(&format!("{name}, its item {number}"), item, true)?;
                }
                Ok(())
            }
            _ => Err(refused(
                format!("{name}: type"),
                "must be \"SimpleItem\" or \"ComplexItem\"",
            )),
        }
    }

    /// Takes an item; `name` stands before the field where it is refused.
    fn command(&mut self, name: &str, item: &MavItem, over: bool) -> Result<(), FieldError> {
        let at = |field: &str| format!("{name}{field}");
        let &MavItem {
            command,
            frame,
            params,
        } = item;
        if LEFT_OUT.contains(&command) {
            self.left_out.push(format!("{name}command {command}"));
            return Ok(());
        }
        // Null and NaN stand for what is left out.
        let param = |n: usize| params[n - 1].filter(|x| x.is_finite());
        let number = |n: usize| param(n).unwrap_or(0.0);
        let place = |home: &Home| -> Result<[f64; 3], FieldError> {
            let field = |n: usize| at(&format!("params[{}]", n - 1));
            let (Some(latitude), Some(longitude)) = (param(5), param(6)) else {
                return Err(refused(field(5), "a place has a latitude and a longitude"));
            };
            if latitude.abs() > 90.0 {
                return Err(refused(field(5), "a latitude is from -90 to 90"));
            }
            if longitude.abs() > 360.0 {
                return Err(refused(field(6), "a longitude is from -360 to 360"));
            }
            let Some(altitude) = param(7) else {
                return Err(refused(field(7), "a place has an altitude"));
            };
            let over_home = if OVER_HOME.contains(&frame) {
                altitude
            } else if OVER_SEA.contains(&frame) {
                altitude - home.0[2]
            } else {
                let problem = format!(
                    "{frame} is neither an altitude over home (3) nor over the sea (0): the terrain is not known"
                );
                return Err(refused(at("frame"), problem));
            };
            let [north, east] = home.local(latitude, longitude);
            Ok([north, east, over_home])
        };
        let somewhere = || number(5) != 0.0 || number(6) != 0.0;
        match command {
            // NAV_WAYPOINT
            16 => {
                let place = place(&self.home)?;
                self.waypoint(place, over, param(1).filter(|hold| *hold > 0.0));
            }
            // NAV_LOITER_UNLIM, _TURNS, _TIME, _TO_ALT
            17 | 18 | 19 | 31 => {
                let [north, east, height] = place(&self.home)?;
                let radius = if command == 31 { number(2) } else { number(3) };
                if radius == 0.0 {
                    let field = if command == 31 {
                        "params[1]"
                    } else {
                        "params[2]"
                    };
                    return Err(refused(at(field), "a loiter has a radius"));
                }
                let mut loiter = entry(
                    "loiter",
                    &[
                        ("north_m", north),
                        ("east_m", east),
                        ("height_m", height),
                        ("radius_m", radius),
                    ],
                );
                match command {
                    18 => put(&mut loiter, "turns", number(1)),
                    19 => put(&mut loiter, "time_s", number(1)),
                    31 => put(&mut loiter, "turns", 0.0),
                    _ => {}
                }
                self.to([north, east]);
                self.length += std::f64::consts::TAU
                    * radius.abs()
                    * if command == 18 { number(1) } else { 0.0 };
                self.items.push(loiter);
            }
            // NAV_RETURN_TO_LAUNCH
            20 => {
                self.to([0.0; 2]);
                self.items.push(Value::String("return".into()));
            }
            // NAV_LAND, NAV_VTOL_LAND
            21 | 85 => {
                let mut fields = Vec::new();
                if somewhere() {
                    let [north, east, _] = place(&self.home)?;
                    self.to([north, east]);
                    fields = vec![("north_m", north), ("east_m", east)];
                }
                self.items.push(entry("land", &fields));
            }
            // NAV_TAKEOFF, NAV_VTOL_TAKEOFF
            22 | 84 => {
                let Some(altitude) = param(7) else {
                    return Err(refused(at("params[6]"), "a take-off has an altitude"));
                };
                let height = if OVER_SEA.contains(&frame) {
                    altitude - self.home.0[2]
                } else {
                    altitude
                };
                self.items.push(entry("take-off", &[("height_m", height)]));
                if somewhere() {
                    let place = place(&self.home)?;
                    if libm::hypot(place[0], place[1]) > 1.0 {
                        self.waypoint(place, false, None);
                    }
                }
            }
            // NAV_CONTINUE_AND_CHANGE_ALT
            30 => {
                let Some(height) = param(7) else {
                    return Err(refused(at("params[6]"), "a change of altitude has one"));
                };
                self.items.push(entry("height", &[("height_m", height)]));
            }
            // DO_CHANGE_SPEED
            178 => {
                if number(1) == 1.0 {
                    let problem = "a speed over ground: only airspeeds (0) are flown";
                    return Err(refused(at("params[0]"), problem));
                }
                if number(1) != 0.0 {
                    return Err(refused(at("params[0]"), "must be an airspeed (0)"));
                }
                if number(2) > 0.0 {
                    self.items.push(entry("speed", &[("speed_m_s", number(2))]));
                }
            }
            other => {
                let problem = format!("MAV_CMD {other} is not flown");
                return Err(refused(at("command"), problem));
            }
        }
        Ok(())
    }

    fn to(&mut self, [north, east]: [f64; 2]) {
        self.length += libm::hypot(north - self.at[0], east - self.at[1]);
        self.at = [north, east];
    }

    fn waypoint(&mut self, [north, east, height]: [f64; 3], over: bool, hover: Option<f64>) {
        let mut waypoint = entry(
            "waypoint",
            &[("north_m", north), ("east_m", east), ("height_m", height)],
        );
        match hover {
            Some(time) => put(&mut waypoint, "hover_s", time),
            None if over => put(&mut waypoint, "over", true),
            None => {}
        }
        self.to([north, east]);
        self.items.push(waypoint);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(items: &str) -> String {
        format!(
            r#"{{"fileType": "Plan", "version": 1, "groundStation": "QGroundControl", "mission": {{"version": 2, "cruiseSpeed": 18,
            "hoverSpeed": 4, "plannedHomePosition": [47.0, 8.0, 400.0], "items": [{items}]}}}}"#
        )
    }

    fn item(command: i64, frame: i64, params: &str) -> String {
        format!(
            r#"{{"type": "SimpleItem", "command": {command}, "frame": {frame}, "params": [{params}], "autoContinue": true}}"#
        )
    }

    fn error(items: &str) -> String {
        plan(&text(items)).unwrap_err().to_string()
    }

    /// A minute of latitude is a nautical mile, one of longitude the cosine of it; an altitude over the sea counts from home.
    #[test]
    fn places_are_metres_from_home() {
        let up = item(22, 3, "0, 0, 0, null, 0, 0, 30");
        let there = item(16, 0, "0, 0, 0, null, 47.0166666667, 8.0166666667, 450");
        let plan = plan(&text(&format!("{up}, {there}"))).unwrap();
        let items = plan.mission["items"].as_array().unwrap();
        assert_eq!(items[0]["take-off"]["height_m"].as_float(), Some(30.0));
        let waypoint = &items[1]["waypoint"];
        let number = |key: &str| waypoint[key].as_float().unwrap();
        assert!((number("north_m") - 1852.9).abs() < 1.0);
        assert!((number("east_m") - 1267.6).abs() < 1.0);
        assert_eq!(number("height_m"), 50.0);
    }

    /// Over the earth and back, to a millimetre; a take-off with a place becomes two items of the same number.
    #[test]
    fn items_of_messages_are_those_of_files() {
        let home = Home([47.0, 8.0, 400.0]);
        let [lat, lon, alt] = home.global([1852.9, -700.0, -30.0]);
        let [north, east] = home.local(lat, lon);
        assert!((north - 1852.9).abs() < 1e-3 && (east + 700.0).abs() < 1e-3 && alt == 430.0);
        let at = |command: i64, place: [f64; 3]| MavItem {
            command,
            frame: 3,
            params: [[0.0; 3].map(Some).as_slice(), &[None], &place.map(Some)]
                .concat()
                .try_into()
                .unwrap(),
        };
        let items = [
            at(84, [lat, lon, 30.0]),
            at(206, [0.0; 3]),
            at(21, [lat, lon, 0.0]),
        ];
        let made = items_flown(&items, home).unwrap();
        let numbers: Vec<usize> = made.iter().map(|(number, _)| *number).collect();
        assert_eq!(numbers, [0, 0, 2]);
        assert_eq!(made[0].1, Item::TakeOff { height: 30.0 });
        let mut wrong = items;
        wrong[2].frame = 10;
        let (number, error) = super::items_flown(&wrong, home).unwrap_err();
        assert_eq!((number, &*error.field), (2, "frame"));
    }

    #[test]
    fn what_is_not_flown_is_refused_by_item_and_field() {
        let up = item(22, 3, "0, 0, 0, null, 0, 0, 30");
        let after = |second: String| error(&format!("{up}, {second}"));
        let place = "47.001, 8.001, 50";
        assert_eq!(
            after(item(16, 10, &format!("0, 0, 0, null, {place}"))),
            "item 1: frame: 10 is neither an altitude over home (3) nor over the sea (0): the terrain is not known"
        );
        assert_eq!(
            after(item(16, 3, "0, 0, 0, null, 97, 8, 50")),
            "item 1: params[4]: a latitude is from -90 to 90"
        );
        assert_eq!(
            after(item(16, 3, "0, 0, 0, null, null, 8, 50")),
            "item 1: params[4]: a place has a latitude and a longitude"
        );
        assert_eq!(
            after(item(177, 2, "1, 3, 0, 0, 0, 0, 0")),
            "item 1: command: MAV_CMD 177 is not flown"
        );
        assert_eq!(
            after(item(178, 2, "1, 12, -1, 0, 0, 0, 0")),
            "item 1: params[0]: a speed over ground: only airspeeds (0) are flown"
        );
        assert_eq!(
            after(item(18, 3, &format!("2, 0, 0, 1, {place}"))),
            "item 1: params[2]: a loiter has a radius"
        );
        assert_eq!(
            after(item(16, 3, "0, 0")),
            "item 1: params: must be seven numbers"
        );
        assert_eq!(
            after(r#"{"type": "ComplexItem", "complexItemType": "fwLandingPattern"}"#.into()),
            "item 1: complexItemType: fwLandingPattern has no items of its own"
        );
        assert_eq!(
            after(r#"{"type": "Other"}"#.into()),
            "item 1: type: must be \"SimpleItem\" or \"ComplexItem\""
        );
        assert!(plan("{").unwrap_err().to_string().contains("is no JSON"));
        assert!(
            plan("{}")
                .unwrap_err()
                .to_string()
                .starts_with("fileType: must")
        );
        let camera = item(206, 2, "20, 0, 1, 0, 0, 0, 0");
        let plan = plan(&text(&format!("{up}, {camera}"))).unwrap();
        assert_eq!(plan.left_out, ["item 1: command 206"]);
    }
}
