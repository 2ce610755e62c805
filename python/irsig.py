"""Signature databases in Python: one file, on sqlite3 and numpy; xarray where it is there.

    import irsig
    with irsig.open("out.sigdb") as db:
        cube = db.query(band="lwir").to_xarray()
        cube.intensity_w_sr.sel(season="summer").plot()

Names, units and errors are those of the database: each number's name ends in its unit, docs/explanation/methods.md says what it is. Reads only;
also while a sweep is being computed (then rows are missing, not wrong). Numbers are those of `irsig query`: nothing is computed here
but what a docstring says.
"""

from __future__ import annotations

import datetime
import json
import os
import pathlib
import sqlite3
import struct
import urllib.parse
import zlib

import numpy

APPLICATION_ID = 0x49525347  # "IRSG"
FORMAT = 29  # of the databases that this file reads

_AXES = {"viewpoint": ("aspect_azimuth_deg", "aspect_elevation_deg", "range_m"),
         "condition": ("season", "time_utc"),
         "band": ("band", "lambda_min_um", "lambda_max_um")}
# Columns of signature_view that are no number of the row itself.
_NO_VALUE = {"signature_id", "row", "sweep", "superseded", *(n for axis in _AXES.values() for n in axis)}
_UNITS = (("_w_m2_sr_um", "W m-2 sr-1 um-1"), ("_w_sr_um", "W sr-1 um-1"), ("_w_m2_sr", "W m-2 sr-1"), ("_w_sr", "W sr-1"),
          ("_w_m2", "W m-2"), ("_m2", "m2"), ("_deg", "degree"), ("_um", "um"), ("_k", "K"), ("_m", "m"), ("_s", "s"))


class Error(Exception):
    """What is wrong with a database or a question, in words."""


def unit(name: str) -> str:
    """Unit of a quantity, from its name's ending; "1" if it has none."""
    return next((said for ending, said in _UNITS if name.endswith(ending)), "1")


def open(path: str | os.PathLike) -> "Database":  # noqa: A001: irsig.open is what it is called
    """A signature database, for reading. Error: no such file, no such database, one of a newer irsig."""
    return Database(path)


def _uri(path: pathlib.Path, *options: str) -> str:
    return f"file:{urllib.parse.quote(str(path))}?" + "&".join(("mode=ro", *options))


def _has_its_journal(path: pathlib.Path) -> bool:
    """Whether all that the database holds can be read: as schema/store/whole_file.h has it."""
    for _ in range(3):  # a run that begins or ends changes header, journal and lock file one after the other
        if _size(path, "-wal") > 32 or _size(path, "-journal") >= 0:
            return True
        # Without locks SQLite refuses a file in write-ahead mode. (To open it by other means and close it would end the locks of all
        # connections of this process.)
        asked = sqlite3.connect(_uri(path, "nolock=1"), uri=True)
        try:
            asked.execute("PRAGMA schema_version").fetchone()
            return True
        except sqlite3.OperationalError as error:
            if "unable to open" not in str(error):
                return True  # what is wrong with it comes out when it is read
        except sqlite3.DatabaseError:
            return True
        finally:
            asked.close()
        lock, here = path.with_name(path.name + "-lock"), path.stat()
        try:
            told = lock.read_text(errors="replace") if lock.is_file() else ""
        except OSError:
            told = ""
        if told == f"whole {here.st_dev} {here.st_ino}\n":
            return True
    return not os.access(path, os.R_OK)  # SQLite says why


def _size(path: pathlib.Path, suffix: str) -> int:
    """-1: there is no such file."""
    try:
        return path.with_name(path.name + suffix).stat().st_size
    except OSError:
        return -1


class Database:
    def __init__(self, path):
        self.path = pathlib.Path(path).resolve()  # a journal lies beside the file, not beside a link to it
        if not self.path.is_file():
            raise Error(f"{path}: there is no such file")
        if sqlite3.sqlite_version_info < (3, 37):
            raise Error(f"{path}: Python's SQLite is {sqlite3.sqlite_version}, expected 3.37 or later (2021): use a newer Python, or the "
                        f"tables that `irsig export {path} --out rows.csv` writes")
        if not _has_its_journal(self.path):
            raise Error(f"{path}: its header says that a journal belongs to it, but {self.path}-wal is missing or empty: the file is an "
                        "incomplete copy, or a hard link to a file whose journal lies beside its other name, or another SQLite program "
                        "closed it after a kill. Copy the database again, with its -wal; if no -wal exists any more, `irsig doctor "
                        f"--accept {path}` reads all of it, lists the jobs without rows and makes it a plain file")
        self._sql = sqlite3.connect(_uri(self.path), uri=True)
        try:
            (application,) = self._sql.execute("PRAGMA application_id").fetchone()
            (self.format,) = self._sql.execute("PRAGMA user_version").fetchone()
        except sqlite3.DatabaseError as error:
            self._sql.close()
            raise Error(f"{path}: {error}") from error
        if application != APPLICATION_ID or self.format != FORMAT:
            self._sql.close()
            raise Error(f"{path}: this is no signature database" if application != APPLICATION_ID else
                        f"{path}: its format is {self.format}, this irsig.py reads {FORMAT}")
        self._sql.row_factory = sqlite3.Row

    def close(self):
        self._sql.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def sql(self, statement: str, *values) -> list[dict]:
        """Rows of any SELECT, as dicts. The tables and views: schema/README.md."""
        return [dict(row) for row in self._sql.execute(statement, values)]

    def _names(self, column: str, table: str) -> list[str]:
        return [row[0] for row in self._sql.execute(f"SELECT DISTINCT {column} FROM {table} ORDER BY 1")]

    @property
    def sweeps(self) -> list[str]:
        return self._names("name", "sweep")

    @property
    def seasons(self) -> list[str]:
        return self._names("season", "condition WHERE superseded = 0")

    @property
    def times_utc(self) -> list[str]:
        return self._names("time_utc", "condition WHERE superseded = 0")

    @property
    def bands(self) -> list[str]:
        return self._names("name", "band WHERE superseded = 0")

    def query(self, *, sweep=None, season=None, time=None, time_utc=None, band=None, aspect=None, nearest=None, within=None,
              at_range_m=None, range_m=None, row=None) -> "Rows":
        """Stored signatures, chosen by the words of `irsig query`. Names are exact; a list of them means any of these.

        time        RFC 3339 with any offset ("2025-12-21T10:30:00+09:00"), a datetime or a numpy.datetime64 (both in UTC without an
                    offset); time_utc: the same as the database writes it ("2025-12-21T01:30:00Z")
        aspect      (azimuth, elevation) [deg], azimuth -360 to 360, elevation -90 to 90: of the viewpoint nearest to it (great circle);
                    its distance is Rows.distance_deg. With nearest=N of the N nearest, with within=DEG of those within so many degrees
        at_range_m  of the viewpoints at this stored range only; range_m is the same. (`irsig query --range-m` shows rows as seen from
                    ranges that are not stored, which is not computed here: `irsig export --range-m` writes them.)
        row         the signature of this row number

        Error: a name that the database does not have; no such direction or range; nothing stored for it.
        """
        if time is not None and time_utc is not None:
            raise Error("time and time_utc: expected one of them")
        if time is not None:
            time_utc = [_utc(t) for t in ([time] if isinstance(time, (str, datetime.datetime, numpy.datetime64)) else time)]
        if range_m is not None and at_range_m is not None:
            raise Error("range_m and at_range_m: expected one of them, they are the same")
        if aspect is None and (nearest is not None or within is not None):
            raise Error("nearest and within: expected aspect=(azimuth, elevation) with them")
        if nearest is not None and within is not None:
            raise Error("nearest and within: expected one of them")
        range_m = at_range_m if range_m is None else range_m
        if sweep is None and len(self.sweeps) > 1:
            raise Error(f"there are several sweeps, expected sweep= one of {', '.join(self.sweeps)}")
        where, values = ["superseded = 0"], []
        for column, asked, known in (("sweep", sweep, self.sweeps), ("season", season, self.seasons),
                                     ("time_utc", time_utc, self.times_utc), ("band", band, self.bands)):
            if asked is None:
                continue
            asked = [asked] if isinstance(asked, str) else list(asked)
            for name in asked:
                if name not in known:
                    raise Error(f'{column}: there is no "{name}", expected {", ".join(known)}')
            where.append(f"{column} IN ({', '.join('?' * len(asked))})")
            values += asked
        if row is not None:
            where.append("row = ?")
            values.append(int(row))
        if range_m is not None:
            known = [r["range_m"] for r in self.sql("SELECT DISTINCT range_m FROM signature_view WHERE superseded = 0 ORDER BY 1")]
            try:
                asked = [float(r) for r in numpy.atleast_1d(range_m)]
            except (TypeError, ValueError):
                raise Error(f"range_m: {range_m!r}, expected a number of metres") from None
            for r in asked:
                if r not in known:
                    raise Error(f"range_m: there is no {r:g}, expected {', '.join(f'{k:g}' for k in known)}; `irsig export --range-m {r:g}` "
                                "writes rows as seen from another range")
            where.append(f"range_m IN ({', '.join('?' * len(asked))})")
            values += asked
        distance = None
        if aspect is not None:
            views, distance = self._nearest(*_aspect(aspect), where, values, nearest, within)
            where.append(f"(aspect_azimuth_deg, aspect_elevation_deg) IN (VALUES {', '.join(['(?, ?)'] * len(views))})")
            values += [angle for view in views for angle in view]
        rows = self.sql(f"SELECT * FROM signature_view WHERE {' AND '.join(where)} ORDER BY sweep, row", *values)
        if not rows:
            raise Error("nothing is stored for this")
        return Rows(self, rows, distance)

    def _nearest(self, azimuth_deg, elevation_deg, where, values, count, within_deg):
        """The viewpoints that are asked for, and how far the farthest of them is."""
        views = self._sql.execute("SELECT DISTINCT aspect_azimuth_deg, aspect_elevation_deg FROM signature_view WHERE "
                                  + " AND ".join(where), values).fetchall()
        if not views:
            raise Error("nothing is stored for this")
        view = numpy.array([tuple(v) for v in views])
        chord = numpy.linalg.norm(_direction(view[:, 0], view[:, 1]) - _direction(azimuth_deg, elevation_deg), axis=-1)
        distance = numpy.degrees(2 * numpy.arcsin(numpy.minimum(1.0, chord / 2)))
        order = numpy.argsort(chord, kind="stable")
        if within_deg is not None:
            order = order[distance[order] <= within_deg]
        elif count is not None and not (isinstance(count, (int, numpy.integer)) and count > 0):
            raise Error(f"nearest: {count!r}, expected a number of viewpoints, 1 or more")
        else:
            order = order[:1 if count is None else count]
        if not len(order):
            raise Error(f"no viewpoint lies within {within_deg:g} degrees of the aspect: the nearest is {distance.min():.4g} away")
        return [[float(x) for x in view[at]] for at in order], float(distance[order[-1]])

    def temperatures(self) -> list[dict]:
        """Computed temperatures: of each part, season and time mean_k, coldest_k, hottest_k, error_k."""
        return self.sql("SELECT season, time_utc, part, mean_k, coldest_k, hottest_k, error_k FROM computed_temperature_view "
                        "WHERE superseded = 0 ORDER BY season, time_utc, part_index")


def _in_cube(name: str) -> str:
    """A spectrum's name beside in-band values: as netCDF has it."""
    return "spectral_" + name if name == "path_transmittance" or name.endswith("_w_sr_um") and "spectral" not in name else name


def _utc(asked) -> str:
    """A time as the database writes it."""
    try:
        if isinstance(asked, numpy.datetime64):
            asked = asked.astype("datetime64[us]").item()
        elif not isinstance(asked, datetime.datetime):
            asked = datetime.datetime.fromisoformat(asked[:-1] + "+00:00" if asked[-1:] in ("Z", "z") else asked)
        if asked.tzinfo is not None:
            asked = asked.astimezone(datetime.timezone.utc)
    except (AttributeError, TypeError, ValueError):
        raise Error(f"time: {asked!r}, expected RFC 3339: 2025-12-21T10:30:00+09:00") from None
    fraction = f"{asked.microsecond:06d}".rstrip("0")
    return asked.strftime("%Y-%m-%dT%H:%M:%S") + (f".{fraction}" if fraction else "") + "Z"


def _aspect(asked) -> tuple[float, float]:
    try:
        azimuth_deg, elevation_deg = (float(angle) for angle in asked)
    except (TypeError, ValueError):
        raise Error(f"aspect: {asked!r}, expected two numbers: azimuth and elevation in degrees") from None
    if not -360 <= azimuth_deg <= 360 or not -90 <= elevation_deg <= 90:
        raise Error(f"aspect: ({azimuth_deg:g}, {elevation_deg:g}), expected an azimuth from -360 to 360 and an elevation from -90 to 90 deg")
    return azimuth_deg, elevation_deg


def _direction(azimuth_deg, elevation_deg):
    azimuth, elevation = numpy.radians(azimuth_deg), numpy.radians(elevation_deg)
    return numpy.stack([numpy.cos(elevation) * numpy.cos(azimuth), numpy.cos(elevation) * numpy.sin(azimuth),
                        numpy.sin(elevation)], axis=-1)


def _exr_pixels(exr: bytes):
    """Pixels of an EXR file as irsig writes it: one channel of float32 in scan lines, packed as run lengths or with zlib."""
    def text(at):
        end = exr.index(b"\0", at)
        return exr[at:end], end + 1

    attribute, at = {}, 8
    while exr[at]:
        name, at = text(at)
        _, at = text(at)
        size = struct.unpack_from("<I", exr, at)[0]
        attribute[name] = exr[at + 4:at + 4 + size]
        at += 4 + size
    at += 1
    lines = {1: 1, 3: 16}[attribute[b"compression"][0]]
    width, height = (v + 1 for v in struct.unpack("<4i", attribute[b"dataWindow"])[2:])
    out = numpy.empty((height, width), "<f4")
    for block, place in enumerate(struct.unpack_from(f"<{-(-height // lines)}Q", exr, at)):
        rows = out[block * lines:(block + 1) * lines]
        size = struct.unpack_from("<I", exr, place + 4)[0]
        packed = exr[place + 8:place + 8 + size]
        if size < rows.nbytes:
            # Even bytes before odd ones, each as the difference from the one before it.
            unpacked = numpy.frombuffer(zlib.decompress(packed) if lines > 1 else _run_lengths(packed), "u1").astype(numpy.int64)
            unpacked[1:] -= 128
            unpacked = unpacked.cumsum().astype("u1")
            whole = numpy.empty(rows.nbytes, "u1")
            whole[::2], whole[1::2] = numpy.split(unpacked, [(rows.nbytes + 1) // 2])
            packed = whole.tobytes()
        rows[:] = numpy.frombuffer(packed, "<f4").reshape(rows.shape)
    return out


def _run_lengths(packed: bytes) -> bytes:
    out, at = bytearray(), 0
    while at < len(packed):
        count = packed[at]
        if count > 127:  # so many other bytes
            out += packed[at + 1:at + 257 - count]
            at += 257 - count
        else:
            out += packed[at + 1:at + 2] * (count + 1)
            at += 2
    return bytes(out)


class Rows:
    """Signatures: rows[name] is an array of one quantity, in the order of the database.

    distance_deg  with aspect=: how far the viewpoint, or the farthest of them, is from what was asked
    """

    def __init__(self, database: Database, rows: list[dict], distance_deg=None):
        self._database, self._rows, self.distance_deg = database, rows, distance_deg

    def __len__(self):
        return len(self._rows)

    @property
    def names(self) -> list[str]:
        return list(self._rows[0])

    def __getitem__(self, name: str) -> numpy.ndarray:
        """Numbers as float64 (NaN: not known), text as objects."""
        if name not in self._rows[0]:
            raise Error(f'there is no quantity "{name}", expected one of {", ".join(self.names)}')
        column = [row[name] for row in self._rows]
        if any(isinstance(value, str) for value in column):
            return numpy.array(column, dtype=object)
        return numpy.array([numpy.nan if value is None else value for value in column], dtype=float)

    def _ids(self):
        return [row["signature_id"] for row in self._rows]

    def _damaged(self, at: int, what: str) -> Error:
        row = self._rows[at]
        return Error(f"row {row['row']} of {row['sweep']}: {what}: the database is damaged")

    def _numbers(self, at: int, blob, kind: str, what: str) -> numpy.ndarray:
        """A blob of the row at this place."""
        if not isinstance(blob, (bytes, type(None))) or len(blob or b"") % numpy.dtype(kind).itemsize:
            raise self._damaged(at, f"{what} are no list of numbers")
        return numpy.frombuffer(blob or b"", kind)

    def spectra(self, name: str = "spectral_intensity_w_sr_um") -> list[tuple[numpy.ndarray, numpy.ndarray]]:
        """(wavelengths [um], values) of each row: means over bins; empty where the row has none.

        Errors of two wavelengths are not independent (both have the same paths): `modes` says how they go together.
        """
        columns = [r["name"] for r in self._database.sql("SELECT name FROM pragma_table_info('spectrum')")][1:]
        if name not in columns:
            raise Error(f'there is no spectrum "{name}", expected one of {", ".join(columns)}')
        out = []
        for at, row in enumerate(self._ids()):
            blobs = self._database._sql.execute(
                f"SELECT b.lambda_um, s.{name} FROM signature JOIN band b USING (band_id) LEFT JOIN spectrum s "
                "USING (signature_id) WHERE signature_id = ?", (row,)).fetchone()
            values = self._numbers(at, blobs[1], "<f4", f"its {name}").astype(float)
            lambda_um = self._numbers(at, blobs[0], "<f8", "its band's wavelengths")
            if len(values) not in (0, len(lambda_um)):
                raise self._damaged(at, f"its {name} has {len(values)} values at {len(lambda_um)} wavelengths")
            out.append((lambda_um if len(values) else lambda_um[:0], values))
        return out

    def modes(self, name: str = "spectral_intensity_w_sr_um") -> list[numpy.ndarray]:
        """Of each row an array [mode, wavelength] of spectra m_k in the unit of the spectrum: how its errors go together.

        The standard error of weights @ spectrum is the root of sum((modes @ weights) ** 2) + (abs(weights) @ rest) ** 2 with
        rest = sqrt(stderr ** 2 - sum(modes ** 2)), at most; without modes (an array of none: nothing is known) it is as if all
        errors were one. name: spectral_intensity_w_sr_um, apparent_... or contrast_...
        """
        column = name.removesuffix("_w_sr_um") + "_modes"
        known = [r["name"] for r in self._database.sql("SELECT name FROM pragma_table_info('spectral_modes')")][1:]
        if column not in known:
            raise Error(f'there are no modes of "{name}", expected one of '
                        + ", ".join(k.removesuffix("_modes") + "_w_sr_um" for k in known))
        out = []
        stderrs = self.spectra(name.removesuffix("_w_sr_um") + "_stderr_w_sr_um")
        for at, (row, (_, stderr)) in enumerate(zip(self._ids(), stderrs)):
            blob = self._database._sql.execute(f"SELECT {column} FROM spectral_modes WHERE signature_id = ?", (row,)).fetchone()
            shares = self._numbers(at, blob[0] if blob else b"", "<i2", f"its {column}")
            if len(stderr) == 0:  # the row has no spectrum, and so nothing to weigh
                out.append(numpy.zeros((0, 0)))
                continue
            if len(shares) % len(stderr):
                raise self._damaged(at, f"its {column} are {len(shares)} values at {len(stderr)} wavelengths")
            out.append(shares.reshape(-1, len(stderr)) / 32767 * stderr)
        return out

    def parts(self) -> list[dict]:
        """Of each row {part: (intensity_w_sr, intensity_stderr_w_sr)}."""
        return [{r["part"]: (r["intensity_w_sr"], r["intensity_stderr_w_sr"]) for r in self._database.sql(
            "SELECT part, intensity_w_sr, intensity_stderr_w_sr FROM part_intensity_view WHERE signature_id = ?", row)}
            for row in self._ids()]

    def ledger(self) -> list[list[dict]]:
        """Of each row: which effects were simulated, why others were not, and how much they could have changed."""
        return [self._database.sql("SELECT effect, state, reason, bound_w_sr, apparent_bound_w_sr, contrast_bound_w_sr, fraction_w_sr "
                                   "FROM ledger_view WHERE signature_id = ?", row) for row in self._ids()]

    def thumbnails(self) -> list[bytes | None]:
        """PNG of each row (black to white over 0 to its largest pixel); None: it has none."""
        return [(self._database._sql.execute("SELECT png FROM thumbnail WHERE signature_id = ?", (row,)).fetchone() or [None])[0]
                for row in self._ids()]

    def images(self, layer: str | None = None, *, stderr: bool = False) -> list:
        """Of each row array [row][column] float32; None: it has no image, or not this layer.

        layer: None, the in-band radiance of the target at the target [W/(m2 sr)] times the fraction of a pixel that it fills; or a name of
        [image] layers. stderr: the standard errors of these numbers, which layers have that are sums over paths: at_sensor,
        emitted, sun, sky, surface, parts and hidden.
        """
        column = "stderr_exr" if stderr else "exr"
        out = []
        for at, row in enumerate(self._ids()):
            found = (self._database._sql.execute(f"SELECT {column} FROM thumbnail WHERE signature_id = ?", (row,)).fetchone()
                     if layer is None else
                     self._database._sql.execute(f"SELECT {column} FROM image_layer WHERE signature_id = ? AND name = ?",
                                                 (row, layer)).fetchone())
            try:
                out.append(_exr_pixels(found[0]) if found and found[0] else None)
            except (ValueError, IndexError, KeyError, struct.error, zlib.error):
                raise self._damaged(at, f"its image{'' if layer is None else ' ' + layer}") from None
        return out

    def image_layers(self) -> list[list[str]]:
        """Names of the layers that each row's image has."""
        return [[name for (name,) in self._database._sql.execute("SELECT name FROM image_layer WHERE signature_id = ? ORDER BY name",
                                                                 (row,))] for row in self._ids()]

    def _frame_of(self, signature):
        """job_id, width, height and rays of a pixel of a row's image; None: it has none."""
        return self._database._sql.execute("SELECT job_id, t.width_px, t.height_px, t.pixel_samples FROM signature s "
                                           "JOIN silhouette t USING (job_id) WHERE s.signature_id = ?", (signature,)).fetchone()

    def silhouettes(self) -> list[dict | None]:
        """Of each row {part: array [row][column]}, the fraction of each pixel of its image that the part fills; None: it has no image."""
        out = []
        for at, signature in enumerate(self._ids()):
            frame = self._frame_of(signature)
            if frame is None:
                out.append(None)
                continue
            job, width, height, samples = frame
            parts = {}
            for part, left, top, w, h, packed in self._database._sql.execute(
                    "SELECT p.name, x.left_px, x.top_px, x.width_px, x.height_px, x.samples FROM part_pixels x JOIN part p USING (part_id) "
                    "WHERE x.job_id = ? ORDER BY p.part_index", (job,)):
                parts[part] = numpy.zeros((height, width))
                try:
                    parts[part][top:top + h, left:left + w] = numpy.frombuffer(zlib.decompress(packed), "<u2").reshape(h, w) / samples
                except (zlib.error, ValueError):
                    raise self._damaged(at, f"the pixels of its part {part}") from None
            out.append(parts)
        return out

    def part_sets(self) -> list[dict | None]:
        """Of each row {parts: (array [row][column], outside)}; None: it has no image.

        parts: names of the parts that rays meet one behind the other, in the sweep's order. The array has the fraction of each pixel whose
        rays meet exactly these, outside is the area that they cover outside the image's frame, in pixels. The whole of some parts, with
        what others hide, is the sum over the sets that have any of them. Empty: the sweep did not ask for [image] whole_parts.
        """
        out = []
        for at, signature in enumerate(self._ids()):
            frame = self._frame_of(signature)
            if frame is None:
                out.append(None)
                continue
            job, width, height, samples = frame
            sets = {}
            for parts, outside, packed in self._database._sql.execute("SELECT parts, outside_px, samples FROM part_set WHERE job_id = ?", (job,)):
                try:
                    numbers = zlib.decompress(packed)
                    count = len(numbers) // 6
                    pixel = numpy.cumsum(numpy.frombuffer(numbers, "<u4", count).astype(numpy.int64) + 1) - 1
                    fraction = numpy.zeros(height * width)
                    fraction[pixel] = numpy.frombuffer(numbers, "<u2", count, 4 * count) / samples
                except (zlib.error, ValueError, IndexError):
                    raise self._damaged(at, f"its rays that meet {parts.replace(chr(10), ', ')}") from None
                sets[tuple(parts.split("\n"))] = fraction.reshape(height, width), outside
            out.append(sets)
        return out

    def to_xarray(self, spectra=None):
        """xarray.Dataset of season x time_of_day x band x viewpoint, NaN where nothing is stored: what `irsig export` writes as netCDF.

        .sel(season=..., band=...) works as it is. time_of_day is in UTC ("01:30:00Z"), the instants are the coordinate
        time_utc(season, time_of_day). Of one season alone, and where a season has several dates, the dimension is `time` instead, of
        instants, and .sel(time="2025-06-21T01:30") works. `viewpoint` counts from 0; aspect and range are coordinates of it.
        part_intensity_w_sr has the dimension part. Spectra, all that the rows have (source, apparent, contrast, by cause), have the
        dimension bin, whose wavelengths are lambda_um(band, bin); spectra=[names] takes these, spectra=() none. With
        spectra also `spectral_intensity_modes_w_sr_um` and those of the apparent and contrast spectrum, of rows that have them,
        over mode and bin: how errors go together (`Rows.modes`).
        """
        import xarray

        if len({row["sweep"] for row in self._rows}) > 1:
            raise Error("rows of several sweeps do not make one cube, expected sweep= in the query")

        def places(of):
            return {key: i for i, key in enumerate(dict.fromkeys(of))}

        views = [tuple(row[name] for name in _AXES["viewpoint"]) for row in self._rows]
        times = [row["time_utc"] for row in self._rows]
        clock = [time.partition("T")[2] for time in times]
        dated = len(set(self["season"])) == 1 or len(set(zip(self["season"], clock))) < len(set(zip(self["season"], times)))
        if dated:
            clock = times
        keys = list(zip(self["season"], clock, self["band"], views))
        axes = [places(row[0] for row in keys), places(sorted(clock)), places(row[2] for row in keys), places(views)]
        at = tuple(numpy.array([axis[row[i]] for row in keys]) for i, axis in enumerate(axes))
        dims = ("season", "time" if dated else "time_of_day", "band", "viewpoint")
        shape = tuple(len(axis) for axis in axes)
        labels = [list(axis) for axis in axes[:3]] + [numpy.arange(len(axes[3]))]
        if dated:
            labels[1] = [numpy.datetime64(time.rstrip("Z"), "ns") for time in axes[1]]
        out = xarray.Dataset(coords=dict(zip(dims, labels)))
        if dated:
            out.coords["time_of_day"] = ("time", [time.partition("T")[2] for time in axes[1]])
        instants = numpy.full(shape[:2], numpy.datetime64("NaT", "ns"))
        instants[at[:2]] = [numpy.datetime64(time.rstrip("Z"), "ns") for time in times]
        out.coords["time_utc"] = (dims[:2], instants)
        for i, name in enumerate(_AXES["viewpoint"]):
            out.coords[name] = ("viewpoint", [view[i] for view in axes[3]], {"units": unit(name)})
        for name in ("lambda_min_um", "lambda_max_um"):
            limits = {row["band"]: row[name] for row in self._rows}
            out.coords[name] = ("band", [limits[band] for band in axes[2]], {"units": "um"})
        for name in self.names:
            if name in _NO_VALUE:
                continue
            column = self[name]
            cube = numpy.full(shape, numpy.nan if column.dtype == float else "", dtype=column.dtype)
            cube[at] = column
            out[name] = (dims, cube, {"units": unit(name)} if column.dtype == float else {})
        parts = self.parts()
        names = places(name for row in parts for name in row)
        for i, name in enumerate(("part_intensity_w_sr", "part_intensity_stderr_w_sr") if names else ()):
            cube = numpy.full((*shape, len(names)), numpy.nan)
            for *place, row in zip(*at, parts):
                for part, values in row.items():
                    cube[(*place, names[part])] = numpy.nan if values[i] is None else values[i]
            out.coords["part"] = list(names)
            out[name] = ((*dims, "part"), cube, {"units": "W sr-1"})
        if spectra is None:
            spectra = [r["name"] for r in self._database.sql("SELECT name FROM pragma_table_info('spectrum')")][1:]
            asked = {name: self.spectra(name) for name in spectra}
            asked = {name: of_row for name, of_row in asked.items() if any(len(values) for _, values in of_row)}
        else:
            asked = {name: self.spectra(name) for name in spectra}
        bins = max((len(values) for of_row in asked.values() for _, values in of_row), default=0)
        for name, of_row in asked.items():
            name = _in_cube(name)
            cube, grid = numpy.full((*shape, bins), numpy.nan), numpy.full((shape[2], bins), numpy.nan)
            for *place, (lambda_um, values) in zip(*at, of_row):
                cube[tuple(place)][:len(values)] = values
                if len(values):
                    grid[place[2], :len(values)] = lambda_um
            out.coords["lambda_um"] = (("band", "bin"), grid, {"units": "um"})
            out[name] = ((*dims, "bin"), cube, {"units": unit(name)})
        all_modes = {name: self.modes(name + "_w_sr_um") for name in
                     ("spectral_intensity", "apparent_spectral_intensity", "contrast_spectral_intensity")} if bins else {}
        most = max((len(modes) for of_row in all_modes.values() for modes in of_row), default=0)
        for name, of_row in all_modes.items() if most else ():
            cube = numpy.full((*shape, most, bins), numpy.nan)
            for *place, modes in zip(*at, of_row):
                if len(modes):  # those of other rows that this one has fewer of are 0
                    cube[tuple(place)][:, :modes.shape[1]] = 0
                    cube[tuple(place)][:len(modes), :modes.shape[1]] = modes
            out[name + "_modes_w_sr_um"] = ((*dims, "mode", "bin"), cube, {"units": unit("_w_sr_um")})
        out.attrs = {"title": f"infrared signatures: {self._rows[0]['sweep']}", "source": "irsig",
                     "provenance": json.dumps({key: sorted({str(row[key]) for row in self._rows})
                                               for key in ("physics_version", "determinism_class", "build_id")})}
        return out
