"""Rows that are moved to another range against direct runs at that range, over random scenes: boxes, spheres, plates and
boxes with a warm upper part, at sea level and above, in a vacuum, in homogeneous air and in the embedded atmosphere; from low
sensors (the horizon inside the silhouette) and from high ones; up to 30 times as far and back.

usage: moved_rows_test.py <irsig> [scenes [first seed]]     20 scenes; 200 print the table of docs/evidence/stability.md
"""
import csv, io, math, pathlib, random, subprocess, sys, tempfile, unittest

IRSIG = pathlib.Path(sys.argv[1]).resolve()
SCENES = int(sys.argv[2]) if len(sys.argv) > 2 else 20
FIRST = int(sys.argv[3]) if len(sys.argv) > 3 else 1
AIRS = ("vacuum", "homogeneous", "atmosphere")
QUANTITIES = {
    "apparent": ("apparent_intensity_w_sr", "apparent_numerical_error_w_sr"),
    "contrast": ("contrast_intensity_w_sr", "contrast_numerical_error_w_sr"),
    "background": ("background_radiance_w_m2_sr", "background_radiance_stderr_w_m2_sr"),
}


def irsig(*arguments):
    return subprocess.run([IRSIG, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


def rows(database, *arguments):
    return list(csv.DictReader(io.StringIO(irsig("query", database, *arguments, "--format", "csv"))))


def solid(kind, size, base_m, turn, first):
    """Vertices and faces of one closed body (a plate: one face), standing at a height of base_m."""
    length, width, height = size
    c, s = math.cos(turn), math.sin(turn)
    place = lambda x, y, z: (c * x - s * y, s * x + c * y, z + base_m)
    if kind == "plate":
        corners = [(0, -width / 2, 0), (0, width / 2, 0), (0, width / 2, height), (0, -width / 2, height)]
        faces = [(0, 1, 2), (0, 2, 3)]
    elif kind == "box":
        corners = [(x * length / 2, y * width / 2, z * height) for z in (0, 1) for y in (-1, 1) for x in (-1, 1)]
        quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
        faces = [f for a, b, e, d in quads for f in ((a, b, e), (a, e, d))]
    else:
        rings, around, radius = 24, 48, height / 2
        corners = [(0, 0, 0)]
        for i in range(1, rings):
            polar = math.pi * i / rings
            corners += [(radius * math.sin(polar) * math.cos(2 * math.pi * j / around),
                         radius * math.sin(polar) * math.sin(2 * math.pi * j / around),
                         radius - radius * math.cos(polar)) for j in range(around)]
        corners.append((0, 0, height))
        at = lambda i, j: 1 + (i - 1) * around + j % around
        faces = [f for j in range(around) for f in ((0, at(1, j + 1), at(1, j)), (len(corners) - 1, at(rings - 1, j),
                                                                                   at(rings - 1, j + 1)))]
        for i in range(1, rings - 1):
            for j in range(around):
                faces += [(at(i, j), at(i, j + 1), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i + 1, j))]
    return [place(*v) for v in corners], [tuple(first + 1 + i for i in f) for f in faces]


class Scene:
    def __init__(self, seed):
        r = random.Random(seed)
        self.seed = seed
        self.air = AIRS[seed % 3]
        kind = r.choice(("plate", "box", "box", "sphere", "two"))
        size = [r.uniform(3, 60), r.uniform(3, 25), r.uniform(3, 30)]
        base_m = r.choice((0, 0, r.uniform(0, 30)))
        turn = 0 if kind == "plate" else r.uniform(0, 2 * math.pi)
        bodies = [("hull", "box" if kind == "two" else kind, size, base_m)]
        if kind == "two":
            bodies.append(("upper", "box", [0.3 * size[0], 0.5 * size[1], r.uniform(2, 8)], base_m + size[2] + 0.01))
        top_m = max(b[3] + b[2][2] for b in bodies)
        reach_m = math.hypot(size[0] / 2, size[1] / 2, top_m)
        length_m = max(size[0], size[1], top_m - base_m, math.hypot(size[0], size[1]))
        near_m = max(20.5 * length_m, 2.5 * reach_m) * math.exp(r.uniform(0, 1))
        far_m = near_m * math.exp(r.uniform(0.2, math.log(30)))
        self.ranges_m = [round(near_m, 1), round(far_m, 1)]
        how = r.choice(("inside", "inside", "low", "high"))
        if how == "inside":  # from the nearer range the horizon is behind the target, at least about
            elevation = math.asin((base_m + r.uniform(0.1, 1.1) * (top_m - base_m)) / near_m)
            self.elevation_deg = math.degrees(elevation)
        else:
            self.elevation_deg = r.uniform(0.05, 3) if how == "low" else r.uniform(3, 75)
        # A plate is seen from its front.
        self.azimuth_deg = r.uniform(-60, 60) % 360 if kind == "plate" else r.uniform(0, 360)
        self.emissivity = r.choice((1.0, 1.0, r.uniform(0.7, 0.98)))
        self.sky_k, self.sea_k = r.uniform(220, 280), r.uniform(275, 298)
        self.target_k = {name: r.uniform(280, 310) if name == "hull" else r.uniform(280, 400) for name, *_ in bodies}
        self.band = r.choice(((8, 12), (3.5, 5)))
        self.visibility_m, self.wind_m_s = r.choice((23000, 50000)), r.uniform(2, 12)
        self.obj, count = "", 0
        for name, form, measures, base in bodies:
            vertices, faces = solid(form, measures, base, turn, count)
            count += len(vertices)
            self.obj += "".join("v {:.7f} {:.7f} {:.7f}\n".format(*v) for v in vertices)
            self.obj += f"g {name}\n" + "".join("f {} {} {}\n".format(*f) for f in faces)

    def toml(self):
        parts = "".join(f'[[part]]\nname = "{n}"\nmaterial = "paint"\ntemperature_k = {k}\n'
                        for n, k in self.target_k.items())
        views = "".join(f"[[viewpoints.aspect]]\nazimuth_deg = {self.azimuth_deg}\nelevation_deg = {self.elevation_deg}\n"
                        f"range_m = {range_m}\n" for range_m in self.ranges_m)
        season = surroundings = ""
        if self.air == "atmosphere":
            season = (f"profile = \"midlatitude_summer\"\nwind_speed_m_s = {self.wind_m_s}\nair_temperature_k = 290\n"
                      "relative_humidity_percent = 70\npressure_pa = 101325\n")
            surroundings = f"sea_temperature_k = {self.sea_k}\nsea_model = \"cox_munk\"\n"
            air = f'model = "atmosphere"\naerosol = "maritime"\nvisibility_m = {self.visibility_m}\n'
        else:
            surroundings = (f"sky_temperature_k = {self.sky_k}\nsea_temperature_k = {self.sea_k}\n"
                            "sea_emissivity = 0.97\n")
            air = 'model = "vacuum"\n'
            if self.air == "homogeneous":
                season = "air_temperature_k = 288\n"
                # A transmittance of 0.1 to 0.9 from the farther range.
                absorption = -math.log(random.Random(-self.seed).uniform(0.1, 0.9)) / (1.2254 * self.ranges_m[1])
                air = (f'model = "homogeneous"\nabsorption_m2_kg = {absorption}\npressure_pa = 101325\n'
                       "gas_constant_j_kg_k = 287\npath_emission = true\n")
        return f"""
name = "moved"
seed = {self.seed}
time = ["12:00Z"]
[model]
file = "p.obj"
unit_m = 1
forward_axis = "+x"
up_axis = "+z"
[[material]]
name = "paint"
kind = "lambert"
emissivity = {self.emissivity}
{parts}[[season]]
name = "any"
date = 2025-06-21
{season}[[band]]
name = "band"
lambda_min_um = {self.band[0]}
lambda_max_um = {self.band[1]}
step_um = 0.1
[viewpoints]
kind = "list"
{views}[surroundings]
kind = "sea"
{surroundings}[air]
{air}[transport]
sun = false
max_reflections = 4
[accuracy]
relative_error = 0.002
[output]
thumbnail_px = 0
"""


def direct_and_moved(folder, toml, obj, ranges_m):
    """Of each range: its row as it was run there, and the row of the other range moved to it."""
    (folder / "p.obj").write_text(obj)
    (folder / "s.toml").write_text(toml)
    database = folder / "s.sigdb"
    irsig("run", folder / "s.toml", "--db", database, "--workers", 1)
    direct = {float(row["range_m"]): row for row in rows(database)}
    out = []
    for to in ranges_m:
        for row in rows(database, "--range-m", to):
            if float(row["stored_range_m"]) != to:
                out.append((to, direct[to], row))
    return out


def z_of(moved, direct, quantity):
    value, error = QUANTITIES[quantity]
    off = float(moved[value]) - float(direct[value])
    # Numbers are printed with some ten digits.
    stated = math.hypot(float(moved[error]), float(direct[error]), 1e-8 * float(direct[value]))
    return off / stated


class MovedRows(unittest.TestCase):
    def test_random_scenes(self):
        z = {(air, quantity): [] for air in AIRS for quantity in QUANTITIES}
        for seed in range(FIRST, FIRST + SCENES):
            scene = Scene(seed)
            with tempfile.TemporaryDirectory() as folder:
                pairs = direct_and_moved(pathlib.Path(folder), scene.toml(), scene.obj, scene.ranges_m)
            for to, direct, moved in pairs:
                for quantity in QUANTITIES:
                    here = z_of(moved, direct, quantity)
                    z[scene.air, quantity].append(here)
                    with self.subTest(seed=seed, to=to, quantity=quantity):
                        value, error = QUANTITIES[quantity]
                        self.assertLess(abs(here), 5, f"{moved[value]} +- {moved[error]}, direct {direct[value]} +- "
                                                      f"{direct[error]}")
                    if SCENES > 20:
                        print(seed, scene.air, quantity, *(round(r) for r in scene.ranges_m), round(scene.elevation_deg, 3),
                              "near" if to == scene.ranges_m[0] else "far", f"{here:.2f}", flush=True,
                              *(f"{float(row[QUANTITIES[quantity][k]]):.6g}" for row in (moved, direct) for k in (0, 1)))
        for (air, quantity), values in z.items():
            if not values:
                continue
            rms = math.sqrt(sum(v * v for v in values) / len(values))
            print(f"| {air} | {quantity} | {len(values)} | {rms:.2f} | {max(map(abs, values)):.2f} |"
                  f" {sum(abs(v) > 5 for v in values)} |")
            if quantity != "background":
                self.assertLess(rms, 1.3)
                if len(values) >= 12:
                    self.assertGreater(rms, 0.2)

    def test_through_a_broken_cloud(self):
        """Model errors of a box at 290 K, 1 and 4 km away and 15 deg up, with half a stratus based at 330 m: the nearer
        line of sight ends below the cloud. One sigma of the cloud in the line of sight is the largest of them by far."""
        scene = Scene(2)
        self.assertEqual(scene.air, "atmosphere")
        scene.elevation_deg, scene.ranges_m, scene.band, scene.emissivity = 15, [1000, 4000], (8, 12), 0.95
        vertices, faces = solid("box", (12, 8, 6), 0, 0.3, 0)
        obj = "".join("v {:.7f} {:.7f} {:.7f}\n".format(*v) for v in vertices) + "g hull\n"
        obj += "".join("f {} {} {}\n".format(*f) for f in faces)
        scene.target_k = {"hull": 330}
        clear = scene.toml()
        broken = clear.replace("[[band]]", '[[season.cloud]]\ntype = "stratus"\ncover = 0.5\n[[band]]', 1)
        errors = {}
        for name, toml in (("clear", clear), ("broken", broken)):
            with tempfile.TemporaryDirectory() as folder:
                for to, direct, moved in direct_and_moved(pathlib.Path(folder), toml, obj, scene.ranges_m):
                    for quantity in ("apparent", "contrast"):
                        column = f"{quantity}_model_error_w_sr"
                        errors[name, to, quantity] = float(direct[column]), float(moved[column])
        for quantity in ("apparent", "contrast"):
            with self.subTest(quantity=quantity):
                direct, moved = errors["broken", 4000, quantity]
                self.assertGreater(direct, 5 * errors["clear", 4000, quantity][0])
                self.assertLess(abs(moved / direct - 1), 0.1, f"{moved}, direct {direct}")
                # Back below the cloud a row states no less than the direct run.
                direct, moved = errors["broken", 1000, quantity]
                self.assertGreater(moved, 0.8 * direct, f"{moved}, direct {direct}")

    # Plates before the horizon: the sensor that is farther looks down on more of the sea. Direct runs and closed forms, W/sr.
    PLATES = {
        1: (8.2244428, 37.4760858, 303.04984873195104, 0.5, (2045, 7282), 266.43584226376515, 286.1001949819155, 3113),
        9: (31.804925, 14.6671195, 302.26432247106, 0.3, (1581, 16962), 241.6976971933155, 291.5391692686111, 3053),
        10: (52.1104442, 32.8272027, 293.2436201221255, 0.5, (2168, 15268), 240.70094091795414, 293.113782301043, 130),
    }

    def test_plates_before_the_horizon(self):
        for seed, (width, height, target_k, elevation_deg, ranges_m, sky_k, sea_k, contrast_w_sr) in self.PLATES.items():
            scene = Scene(3 * seed)
            scene.air, scene.azimuth_deg, scene.emissivity, scene.band = "vacuum", 0, 1.0, (8, 12)
            scene.elevation_deg, scene.ranges_m, scene.sky_k, scene.sea_k = elevation_deg, ranges_m, sky_k, sea_k
            scene.target_k = {"hull": target_k}
            vertices, faces = solid("plate", (0, width, height), 0, 0, 0)
            obj = "".join("v {:.7f} {:.7f} {:.7f}\n".format(*v) for v in vertices)
            obj += "g hull\n" + "".join("f {} {} {}\n".format(*f) for f in faces)
            toml = scene.toml().replace("sea_emissivity = 0.97", "sea_emissivity = 1.0")
            with tempfile.TemporaryDirectory() as folder, self.subTest(plate=seed):
                pairs = direct_and_moved(pathlib.Path(folder), toml, obj, ranges_m)
                (moved,) = [moved for to, _, moved in pairs if to == ranges_m[1]]
                error = float(moved["contrast_numerical_error_w_sr"])
                self.assertLess(abs(float(moved["contrast_intensity_w_sr"]) - contrast_w_sr), 3 * error + 1)
                self.assertLess(error, 0.02 * float(moved["apparent_intensity_w_sr"]))
                for to, direct, moved in pairs:
                    for quantity in QUANTITIES:
                        self.assertLess(abs(z_of(moved, direct, quantity)), 5, (to, quantity))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
