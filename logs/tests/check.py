#!/usr/bin/env python3
"""Holds alula-logs against programs that others wrote: pyulog, the mcap reader, pymavlink.

    python3 -m venv target/venv && target/venv/bin/pip install pyulog==1.3.0 mcap==1.6.0 pymavlink==2.4.50
    target/venv/bin/python logs/tests/check.py [ULOG …]

Writes a CSV, a ULog and a DataFlash log here, has `examples/convert.rs` turn them into ULog, MCAP and CSV, and compares
every number that the other programs read with the number that was meant. Also: a ULog that pyulog wrote is read; a flight that
`alula-sil fly --log` left is compared with its trace; the ULog written here goes through `alula-sil replay`. Of each ULog
named, every number is compared with pyulog's. MCAP as its own writer packs it, by zstd and lz4, is read, with stamps in any unit.
"""

import csv
import json
import math
import random
import re
import struct
import subprocess
import sys
import tempfile
from pathlib import Path
from xml.etree import ElementTree

from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer
from pymavlink import DFReader
from pyulog import ULog
from pyulog.px4 import PX4ULog

ROOT = Path(__file__).resolve().parents[2]
LAYOUT = ROOT / "examples/plotjuggler/flight.xml"
ROWS = 500
compared = 0


def convert(source, target, *topic):
    command = ["cargo", "run", "--quiet", "--release", "-p", "alula-logs", "--example", "convert", "--"]
    subprocess.run([*command, str(source), str(target), *topic], cwd=ROOT, check=True)


def same(found, meant, what, tolerance=0.0):
    """Fails unless the two sequences hold the same numbers; NaN is NaN."""
    global compared
    found, meant = [float(v) for v in found], [float(v) for v in meant]
    assert len(found) == len(meant), f"{what}: {len(found)} values, not {len(meant)}"
    for row, (a, b) in enumerate(zip(found, meant)):
        both = math.isnan(a) and math.isnan(b)
        assert both or abs(a - b) <= tolerance, f"{what}, row {row}: {a!r}, not {b!r}"
    compared += len(meant)


def read_csv(path):
    """Column → numbers, the unit cut off."""
    with open(path, newline="") as file:
        header, *rows = list(csv.reader(file))
    names = [name.split(" [")[0] for name in header]
    cells = zip(*rows) if rows else [[] for _ in names]
    return {name: [float(cell) if cell else math.nan for cell in column] for name, column in zip(names, cells)}


def read_ulog(path):
    """(topic, instance) → column → numbers, and the units."""
    log = ULog(str(path))
    assert not log.file_corruption, "pyulog calls the file corrupt"
    PX4ULog(log).add_roll_pitch_yaw()
    topics = {(d.name, d.multi_id): d.data for d in log.data_list}
    units = [value for part in log.msg_info_multiple_dict.get("units", []) for value in part]
    return topics, dict(unit.split("=", 1) for unit in units)


def read_mcap(path):
    """Topic → column → numbers, arrays taken apart, and topic → field → unit."""
    topics, units = {}, {}
    with open(path, "rb") as file:
        for schema, channel, message in make_reader(file, validate_crcs=True).iter_messages():
            assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
            properties = json.loads(schema.data)["properties"]
            units[channel.topic] = channel.metadata
            columns = topics.setdefault(channel.topic, {})
            row = json.loads(message.data)
            assert message.log_time == round(row["timestamp"] * 1e9)
            for name, value in row.items():
                assert ("items" in properties[name]) == isinstance(value, list)
                cells = {f"{name}[{i}]": v for i, v in enumerate(value)} if isinstance(value, list) else {name: value}
                for column, cell in cells.items():
                    columns.setdefault(column, []).append(math.nan if cell is None else cell)
    return topics, units


def check_csv(directory):
    """A CSV, through ULog and MCAP, and through a ULog that pyulog wrote."""
    draw = random.Random(1)
    single = lambda v: struct.unpack("<f", struct.pack("<f", v))[0]
    columns = {
        "time [s]": [1 + 0.02 * row for row in range(ROWS)],
        "x [m]": [draw.gauss(0, 100) for _ in range(ROWS)],
        "q[0]": [single(draw.uniform(-1, 1)) for _ in range(ROWS)],
        "q[1]": [single(draw.uniform(-1, 1)) for _ in range(ROWS)],
        "tiny [N*m]": [draw.uniform(-1, 1) * 10 ** draw.uniform(-300, 300) for _ in range(ROWS)],
        "gaps": [math.nan if row % 7 == 0 else row for row in range(ROWS)],
    }
    source = directory / "table.csv"
    with open(source, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(["" if math.isnan(v) else repr(v) for v in row] for row in zip(*columns.values()))
    meant = read_csv(source)

    for name in ["table.ulg", "table.mcap", "table-again.csv"]:
        convert(source, directory / name)
    topics, units = read_ulog(directory / "table.ulg")
    assert list(topics) == [("csv", 0)], list(topics)
    assert units == {"csv.x": "m", "csv.tiny": "N*m"}, units
    found = topics["csv", 0]
    assert found["q[0]"].dtype == "float32" and found["x"].dtype == "float64"
    # ULog keeps microseconds.
    same(found["timestamp"] / 1e6, meant["time"], "ulog time", 0.5e-6 + 1e-12)
    for column in list(meant)[1:]:
        same(found[column], meant[column], f"ulog {column}")

    topics, units = read_mcap(directory / "table.mcap")
    assert units == {"csv": {"x": "m", "q": "", "tiny": "N*m", "gaps": ""}}, units
    same(topics["csv"]["timestamp"], meant["time"], "mcap time")
    for column in list(meant)[1:]:
        same(topics["csv"][column], meant[column], f"mcap {column}")

    again = read_csv(directory / "table-again.csv")
    assert list(again) == list(meant)
    for column in meant:
        same(again[column], meant[column], f"csv {column}")

    # pyulog writes what it read; ours reads that.
    ULog(str(directory / "table.ulg")).write_ulog(str(directory / "pyulog.ulg"))
    convert(directory / "pyulog.ulg", directory / "pyulog.csv")
    again = read_csv(directory / "pyulog.csv")
    same(again["time"], meant["time"], "pyulog time", 0.5e-6 + 1e-12)
    for column in list(meant)[1:]:
        same(again[column], meant[column], f"pyulog {column}")


def write_ulog(path):
    """What PX4 writes and ours does not: nested formats, padding, instances, integers, text, other kinds of message."""
    draw = random.Random(3)
    out = bytearray(b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 5))

    def message(kind, payload):
        out.extend(struct.pack("<HB", len(payload), ord(kind)) + payload)

    def keyed(kind, key, value):
        message(kind, bytes([len(key)]) + key.encode() + value)

    message("B", bytes(40))
    keyed("I", "char[3] sys_name", b"PX4")
    keyed("P", "float MC_ROLL_P", struct.pack("<f", 6.5))
    message("F", b"vehicle_attitude:uint64_t timestamp;float[4] q;uint8_t reset;uint8_t[3] _padding0;")
    message("F", b"esc_status:uint64_t timestamp;esc_report[2] esc;uint8_t count;char[4] name;uint8_t[3] _padding0;")
    message("F", b"esc_report:uint64_t timestamp;int32_t rpm;int8_t temperature;uint8_t[3] _padding0;")
    message("F", b"airspeed:uint64_t timestamp;uint64_t timestamp_sample;bool ok;int16_t raw;double value;")
    message("F", b"vehicle_local_position:uint64_t timestamp;float x;float y;float z;float vx;float vy;float vz;")
    message("F", b"wind:uint64_t timestamp;float windspeed_north;float windspeed_east;")
    message("F", b"airspeed_validated:uint64_t timestamp;float true_airspeed_m_s;")
    message("F", b"vehicle_status:uint64_t timestamp;bool is_vtol;bool is_vtol_tailsitter;")
    setpoint = "vehicle_local_position_setpoint"
    message("F", f"{setpoint}:uint64_t timestamp;float x;float y;float z;float vx;float vy;float vz;float[3] acceleration;".encode())
    names = [("vehicle_attitude", 0), ("esc_status", 0), ("airspeed", 0), ("airspeed", 1), ("vehicle_local_position", 0),
             ("wind", 0), ("airspeed_validated", 0), ("vehicle_status", 0), (setpoint, 0)]
    for number, (name, instance) in enumerate(names):
        message("A", struct.pack("<BH", instance, number) + name.encode())
    message("D", struct.pack("<HQ??", 7, 900_000, True, True))
    for row in range(ROWS):
        time = 1_000_000 + 4000 * row
        message("D", struct.pack("<HQ4fB", 0, time, *[draw.uniform(-1, 1) for _ in range(4)], row % 256))
        escs = b"".join(struct.pack("<Qib3x", time, draw.randrange(-2**31, 2**31), draw.randrange(-128, 128)) for _ in "01")
        message("D", struct.pack("<HQ", 1, time + 1) + escs + struct.pack("<B4s", 2, b"pair"))
        for instance in range(2):
            values = (row % 2 == 0, draw.randrange(-32768, 32768), draw.gauss(0, 1e9))
            message("D", struct.pack("<HQQ?hd", 2 + instance, time + 2, time - 7, *values))
        message("D", struct.pack("<HQ6f", 4, time - 3, *[draw.gauss(0, 30) for _ in range(6)]))
        if row % 10 == 5:
            message("D", struct.pack("<HQ2f", 5, time - 2, draw.gauss(0, 3), draw.gauss(0, 3)))
            message("D", struct.pack("<HQf", 6, time - 1, draw.uniform(5, 20)))
            message("D", struct.pack("<HQ9f", 8, time - 1, *[draw.gauss(0, 3) for _ in range(8)], math.nan))
        if row % 50 == 0:
            message("L", struct.pack("<BQ", ord("6"), time) + b"a line")
            message("S", bytes([0x2F, 0x73, 0x13, 0x20, 0x25, 0x0C, 0xBB, 0x12]))
            message("O", struct.pack("<H", 3))
            message("z".upper(), b"a kind of message that nobody knows")
    out.extend(b"\x20\x00D\x00")
    path.write_bytes(out)


def check_ulog(source, directory):
    """A ULog, through MCAP, against pyulog."""
    meant = {}
    for data in ULog(str(source)).data_list:
        name = data.name if data.multi_id == 0 else f"{data.name}.{data.multi_id}"
        texts = {f.field_name for f in data.field_data if f.type_str == "char"}
        # pyulog keeps padding within nested formats.
        columns = {c: v for c, v in data.data.items() if c not in texts and "_padding" not in c}
        if len(columns) > 1:
            meant[name] = columns
    convert(source, directory / "ulog.mcap")
    found, _ = read_mcap(directory / "ulog.mcap")
    assert set(found) == set(meant), set(found) ^ set(meant)
    for name, columns in meant.items():
        same([t * 1e6 for t in found[name]["timestamp"]], columns["timestamp"], f"{name} time", 1e-3)
        for column, values in columns.items():
            if column != "timestamp":
                # MCAP's fields are identifiers, but for the indices of arrays.
                plain = column if re.fullmatch(r"\w+\[\d+\]", column) else re.sub(r"\W", "_", column)
                # JSON has no infinities.
                values = [v if math.isfinite(v) else math.nan for v in map(float, values)]
                same(found[name][plain], values, f"{name} {column}")
    return len(meant)


def check_states(source, directory):
    """The states of a tail-sitter's log, from what pyulog reads: the last value held on the times of the attitude."""
    topics, _ = read_ulog(source)
    convert(source, directory / "states.csv", "states")
    found = read_csv(directory / "states.csv")
    base = topics["vehicle_attitude", 0]["timestamp"]

    def held(topic, column):
        data = topics[topic, 0]
        last = [sum(1 for t in data["timestamp"] if t <= time) - 1 for time in base]
        pick = lambda of: [float(of[row]) if row >= 0 else math.nan for row in last]
        return pick(data[column]), [(t - at) / 1e6 for t, at in zip(map(float, base), pick(data["timestamp"]))]

    position, setpoint = "vehicle_local_position", "vehicle_local_position_setpoint"
    sources = {"pn": (position, "x"), "pe": (position, "y"), "pd": (position, "z"),
               "vn": (position, "vx"), "ve": (position, "vy"), "vd": (position, "vz"),
               "wn": ("wind", "windspeed_north"), "we": ("wind", "windspeed_east"),
               "airspeed": ("airspeed_validated", "true_airspeed_m_s"),
               "pn_sp": (setpoint, "x"), "ve_sp": (setpoint, "vy"),
               "an_sp": (setpoint, "acceleration[0]"), "ad_sp": (setpoint, "acceleration[2]")}
    same([t * 1e6 for t in found["time"]], base, "states time", 1e-3)
    for column, place in sources.items():
        values, age = held(*place)
        same(found[column], values, f"states {column}")
        if column in ("vn", "airspeed"):
            ages = [a if math.isfinite(a) else math.nan for a in found[column + "_age"]]
            same(ages, age, f"age of {column}", 1e-9)
    # PX4's quaternion of length 1, times 90 degrees about y, by the matrix of the product.
    half = math.sqrt(0.5)
    hover = [[float(topics["vehicle_attitude", 0][f"q[{i}]"][row]) for i in range(4)] for row in range(len(base))]
    for name, product in {"qw": lambda w, x, y, z: w - y, "qx": lambda w, x, y, z: x - z,
                          "qy": lambda w, x, y, z: y + w, "qz": lambda w, x, y, z: z + x}.items():
        same(found[name], [half * product(*q) / math.hypot(*q) for q in hover], f"states {name}", 1e-15)


def check_layout(source):
    """Every curve of the PlotJuggler layout is in the log `source`, under the name that PlotJuggler gives it."""
    log = ULog(str(source))
    names = set()
    for data in log.data_list:
        for column in data.data:
            # PlotJuggler's ulog_parser.cpp: topic/field, elements of arrays .00, .01, …
            names.add(f"{data.name}/" + re.sub(r"\[(\d+)\]", lambda m: f".{int(m[1]):02}", column))
    curves = [curve.get("name") for curve in ElementTree.parse(LAYOUT).iter("curve")]
    assert curves and set(curves) <= names, set(curves) - names
    assert len(curves) == len(set(curves))


# Letter → struct, of the letters used below.
LETTERS = {"B": "B", "b": "b", "n": "4s", "N": "16s", "Z": "64s", "Q": "Q", "d": "d", "f": "f", "c": "h", "C": "H",
           "h": "h", "L": "i", "e": "i", "g": "e"}
# Name, format, labels, units, multipliers, as in ArduPilot's LogStructure.h; TST holds what the others do not.
FORMATS = {
    128: ("FMT", "BBnNZ", "Type,Length,Name,Format,Columns", "-b---", "-----"),
    2: ("UNIT", "QbZ", "TimeUS,Id,Label", "s--", "F--"),
    3: ("MULT", "Qbd", "TimeUS,Id,Mult", "s--", "F--"),
    4: ("FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds", "s---", "F---"),
    10: ("XKF1", "QBccCfffffffccce", "TimeUS,C,Roll,Pitch,Yaw,VN,VE,VD,dPD,PN,PE,PD,GX,GY,GZ,OH",
         "s#ddhnnnnmmmkkkm", "F-BBB0000000BBBB"),
    11: ("POS", "QLLfff", "TimeUS,Lat,Lng,Alt,RelHomeAlt,RelOriginAlt", "sDUmmm", "FGG000"),
    12: ("TST", "Qhgd", "TimeUS,Centi,Half,Double", "sm-r", "FB--"),
    13: ("MSG", "QZ", "TimeUS,Message", "s-", "F-"),
}
UNITS = {"s": "s", "d": "deg", "h": "degheading", "n": "m/s", "m": "m", "k": "deg/s", "D": "deglatitude",
         "U": "deglongitude", "r": "rad", "#": "instance", "-": ""}
MULTIPLIERS = {"-": 0, "?": 1, "0": 1, "B": 1e-2, "F": 1e-6, "G": 1e-7}


def write_dataflash(path):
    draw = random.Random(2)
    out = bytearray()

    def message(kind, *values):
        layout = "<3B" + "".join(LETTERS[letter] for letter in FORMATS[kind][1])
        values = [v.encode() if isinstance(v, str) else v for v in values]
        out.extend(struct.pack(layout, 0xA3, 0x95, kind, *values))

    for kind, (name, letters, labels, _, _) in FORMATS.items():
        size = struct.calcsize("<3B" + "".join(LETTERS[letter] for letter in letters))
        message(128, kind, size, name, letters, labels)
    for letter, unit in UNITS.items():
        message(2, 0, ord(letter), unit)
    for letter, multiplier in MULTIPLIERS.items():
        message(3, 0, ord(letter), struct.unpack("<f", struct.pack("<f", multiplier))[0])
    for kind, (_, _, _, units, multipliers) in FORMATS.items():
        message(4, 0, kind, units, multipliers)
    for row in range(ROWS):
        time = 1_000_000 + 20_000 * row
        for core in range(2):
            angles = [draw.randrange(-18000, 18000), draw.randrange(-9000, 9000), draw.randrange(36000)]
            floats = [draw.gauss(0, 20) for _ in range(7)]
            message(10, time + core, core, *angles, *floats, *[draw.randrange(-999, 999) for _ in range(3)], row)
        message(11, time, 473977000 + row, 85456000 - row, 488.0 + row / 8, row / 8, row / 8)
        message(12, time, draw.randrange(-32768, 32768), draw.uniform(-9, 9), draw.gauss(0, 1))
        if row % 100 == 0:
            message(13, time, f"row {row}, and a comma")
    path.write_bytes(out)


def check_dataflash(directory):
    """A DataFlash log, binary and text, against pymavlink, and through ULog and MCAP."""
    source = directory / "log.bin"
    write_dataflash(source)
    reader = DFReader.DFReader_binary(str(source))
    meant = {}
    lines = []
    while (message := reader.recv_msg()) is not None:
        name = message.get_type()
        cells = [str(v) for v in (getattr(message, c) for c in message.get_fieldnames())]
        lines.append(", ".join([name, *cells]))
        if name in ("XKF1", "POS", "TST"):
            rows = meant.setdefault((name, getattr(message, "C", 0)), {})
            for column in message.get_fieldnames():
                # pymavlink leaves the multiplier of a plain integer to its reader.
                value = getattr(message, column) / (100 if column == "Centi" else 1)
                rows.setdefault(column, []).append(value)
    assert len(meant) == 4 and all(len(rows["TimeUS"]) == ROWS for rows in meant.values())
    (directory / "log.log").write_text("\n".join(lines) + "\n")

    for target in ["log.ulg", "log.mcap"]:
        convert(source, directory / target)
    ulog, units = read_ulog(directory / "log.ulg")
    assert units["XKF1.VN"] == "m/s" and units["POS.Lat"] == "deglatitude" and units["TST.Centi"] == "m", units
    mcap, _ = read_mcap(directory / "log.mcap")
    assert set(ulog) == set(meant), set(ulog)
    for (name, instance), rows in meant.items():
        files = {"bin": source, "log": directory / "log.log"}
        for kind, file in files.items():
            target = directory / f"{name}-{instance}-{kind}.csv"
            convert(file, target, f"{name}.{instance}")
            found = read_csv(target)
            same([t * 1e6 for t in found["time"]], rows["TimeUS"], f"{kind} {name} time", 1e-6)
            for column in list(rows)[1:]:
                # The widest numbers, degrees, carry 1e-14 of rounding where pymavlink multiplies by 1e-7.
                same(found[column], rows[column], f"{kind} {name} {column}", 1e-13 if kind == "bin" else 1e-12)
        channel = name if instance == 0 else f"{name}.{instance}"
        same(ulog[name, instance]["timestamp"], rows["TimeUS"], f"ulog {name} time")
        for column in list(rows)[1:]:
            same(ulog[name, instance][column], rows[column], f"ulog {name} {column}", 1e-13)
            same(mcap[channel][column], rows[column], f"mcap {name} {column}", 1e-13)


def alula(*arguments):
    command = ["cargo", "run", "--quiet", "--release", "-p", "alula-sil", "--"]
    return subprocess.run([*command, *map(str, arguments)], cwd=ROOT, check=True, capture_output=True, text=True).stdout


def check_flight(directory, experiment, some):
    """What `fly --log` leaves holds the numbers of the trace, with units, of which `some`, and every curve of the PlotJuggler layout."""
    alula("fly", experiment, "--log", "ulog,mcap", "--out", directory)
    words = {"told_air", "status", "mode", "phase", "unreachable", "air"}
    with open(directory / "trace.csv", newline="") as file:
        trace = {column: cells for column, *cells in zip(*csv.reader(file)) if column not in words}
    ulog, units = read_ulog(directory / "flight.ulg")
    mcap, mcap_units = read_mcap(directory / "flight.mcap")
    single = lambda cell: struct.unpack("<f", struct.pack("<f", float(cell)))[0]
    for column, cells in trace.items():
        # The controller's numbers stand in the trace in the shortest decimals of single precision.
        found = ulog["alula", 0][column]
        exact = str(found.dtype) == "float64"
        same(found, map(float if exact else single, cells), f"ulog {column}")
        finite = [float(v) if math.isfinite(v) else math.nan for v in found]
        same(mcap["alula"][column], finite, f"mcap {column}")
    assert set(mcap["alula"]) == {"timestamp", *trace}, set(mcap["alula"]) ^ set(trace)
    for column, unit in {"thrust_n": "N", "t_s": "s", **some}.items():
        assert units[f"alula.{column}"] == unit and mcap_units["alula"][column] == unit, column
    check_layout(directory / "flight.ulg")


def check_replay(source, directory):
    """The guidance over a log of PX4's topics, in the plane and in space: a command for each attitude, and a page of margins."""
    for experiment in ["round-trip", "eight"]:
        out = directory / f"replay-{experiment}"
        alula("replay", source, "--experiment", experiment, "--out", out)
        rows = (out / "commands.csv").read_text().splitlines()
        assert len(rows) == 1 + ROWS, len(rows)
        assert "angle to the nearest fold" in (out / "report.html").read_text()


def check_mcap(directory):
    """MCAP as its own writer packs it, in many chunks, with stamps in each unit."""
    draw = random.Random(2)
    times = [2 + 0.05 * row for row in range(ROWS)]
    values = [[draw.gauss(0, 10) for _ in range(4)] for _ in range(ROWS)]
    for compression in CompressionType:
        for unit in [1, 1e3, 1e6]:
            source, target = directory / "packed.mcap", directory / "packed.csv"
            with open(source, "wb") as file:
                writer = Writer(file, compression=compression, chunk_size=4096)
                writer.start()
                schema = writer.register_schema(name="t", encoding="jsonschema", data=b"{}")
                channel = writer.register_channel(topic="t", message_encoding="json", schema_id=schema)
                for time, row in zip(times, values):
                    data = json.dumps({"timestamp": round(time * unit, 6), "q": row}).encode()
                    writer.add_message(channel_id=channel, log_time=round(time * 1e9), publish_time=0, data=data)
                writer.finish()
            convert(source, target, "t")
            found = read_csv(target)
            same(found["time"], times, f"{compression} time", 1e-9)
            for i in range(4):
                same(found[f"q[{i}]"], [row[i] for row in values], f"{compression} q[{i}]")


def main():
    with tempfile.TemporaryDirectory() as directory:
        directory = Path(directory)
        check_csv(directory)
        check_mcap(directory)
        write_ulog(directory / "px4.ulg")
        assert check_ulog(directory / "px4.ulg", directory) == 9
        check_states(directory / "px4.ulg", directory)
        check_layout(directory / "px4.ulg")
        check_dataflash(directory)
        check_flight(directory / "flight", "round-trip", {"pitch_rate_rad_s": "rad/s", "told_vr_down_m_s": "m/s"})
        check_flight(directory / "in-space", "eight", {"bank_rad": "rad", "path_v_east_m_s": "m/s"})
        check_replay(directory / "px4.ulg", directory)
        for source in sys.argv[1:]:
            print(f"{source}: {check_ulog(Path(source).resolve(), directory)} topics")
    print(f"{compared} numbers compared: as meant")


if __name__ == "__main__":
    sys.exit(main())
