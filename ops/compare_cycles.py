#!/usr/bin/env python3
"""Compares irsig's images of a frigate with those of Cycles, Blender's path tracer, pixel by pixel.

usage: ops/compare_cycles.py IRSIG FOLDER [SEEDS [SAMPLES]]

Creates FOLDER, works there and prints a table. SEEDS: irsig runs whose images are averaged (default 16). SAMPLES: rays
per pixel of each of two Cycles images (default 512). Needs Blender, and numpy in its Python (tested: 3.4.1 of Debian
12, apt-get install --no-install-recommends blender). Both programs read one mesh. Each part has one temperature and a
grey, diffuse emissivity, so that one number is its in-band radiance; the sensor is a pinhole in vacuum.
The table has irsig / Cycles - 1 of interior pixels, which one part fills with their eight neighbours in all runs, and
of each part's sum over them. Errors for z combine irsig's stated errors with the noise of Cycles (rms over a part).
Fill is irsig's coverage of edge pixels less that of Cycles. The sums of radiance x solid angle x range^2 stand against
the rows' mean intensity. Exit code 1: in a view fewer than 99 % of the interior pixels agree within 1 % or three
errors, or a part's sum differs by more than 0.5 %.
"""
import csv, math, pathlib, sqlite3, subprocess, sys, zlib

try:
    import bpy, mathutils, numpy
except ImportError:  # started by Python instead of Blender
    if not 3 <= len(sys.argv) <= 5:
        sys.exit(__doc__)
    (work := pathlib.Path(sys.argv[2])).mkdir(parents=True)
    with open(work / "blender.log", "w") as log:
        code = subprocess.run(["blender", "-b", "--factory-startup", "--python-exit-code", "2", "--python", __file__,
                               "--", *sys.argv[1:]], stdout=log, stderr=log).returncode
    print((work / "table.md").read_text().strip() if code in (0, 1) else f"Blender failed; see {work / 'blender.log'}")
    sys.exit(code)

PARTS = {  # temperature [K], emissivity
    "hull": (295, 0.9), "deck": (305, 0.4), "superstructure": (300, 0.5), "funnel": (320, 0.7),
    "mast": (290, 0.6), "turret": (310, 0.8), "funnel_top": (400, 0.95), "mast_hot": (400, 0.3)}
VARIANTS = {  # reflections, radiance of the sky and of the lower hemisphere [W/(m2 sr um)]
    "emission": (0, 0, 0), "reflections": (64, 0, 0), "reflections, sky": (64, 4, 10)}
VIEWS = [(30, 10, 5000), (90, 30, 2000), (160, 60, 1000), (235, 3, 600), (310, -15, 400)]  # aspect [deg], range [m]
LAMBDA_UM, LONG_SIDE_PX = (8, 12), 320
COLUMNS = ("variant", "view", "interior px", "irsig noise %", "Cycles noise %", "mean %", "median %", "rms %", "95th %",
           "99th %", "worst part %", "z rms, one run", "z rms", "agree %", "edge px", "fill mean", "fill rms",
           "edge z rms", "area %", "sum irsig %", "sum Cycles %")
PIXELS_OF_PARTS = """SELECT p.name, x.left_px, x.top_px, x.width_px, x.height_px, x.samples, t.pixel_samples
FROM signature_view v JOIN signature s USING (signature_id) JOIN silhouette t USING (job_id)
JOIN part_pixels x USING (job_id) JOIN part p USING (part_id) WHERE v.row = ?"""


def read_exr(path):
    """Returns the channels of an image as an array [row from the top][column][RGBA]."""
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.is_data = True
    pixels = numpy.array(image.pixels[:]).reshape(image.size[1], image.size[0], 4)[::-1]
    bpy.data.images.remove(image)
    return pixels


def irsig_images(irsig, folder, variant, seed):
    """Runs a sweep; returns of each view its labels, image, standard errors [W/(m2 sr)] and parts' pixel fractions."""
    (reflections, sky, lower), view = VARIANTS[variant], "{{ azimuth_deg = {}, elevation_deg = {}, range_m = {} }}"
    text = f"""name = "cycles"
seed = {seed}
time = ["12:00Z"]
model = {{ file = "frigate.obj", unit_m = 1, forward_axis = "+x", up_axis = "+z" }}
season = [{{ name = "any", date = 2025-06-21 }}]
band = [{{ name = "lwir", lambda_min_um = {LAMBDA_UM[0]}, lambda_max_um = {LAMBDA_UM[1]}, step_um = 0.1 }}]
surroundings = {{ kind = "none", sky_radiance_w_m2_sr_um = {sky}, lower_radiance_w_m2_sr_um = {lower} }}
air = {{ model = "vacuum" }}
transport = {{ sun = false, max_reflections = {reflections} }}
accuracy = {{ relative_error = 0.002 }}
effects = {{ mode = "all" }}
output = {{ thumbnail_px = {LONG_SIDE_PX} }}
viewpoints = {{ kind = "list", aspect = [{", ".join(view.format(*v) for v in VIEWS)}] }}\n"""
    for name, (temperature_k, emissivity) in PARTS.items():
        text += (f'[[material]]\nname = "grey_{name}"\nkind = "lambert"\nemissivity = {emissivity}\n[[part]]\n'
                 f'name = "{name}"\nmaterial = "grey_{name}"\ntemperature_k = {temperature_k}\n')
    sweep, database, pictures = (folder / f"{variant}-{seed}{end}" for end in (".toml", ".sigdb", ".pictures"))
    sweep.write_text(text)
    subprocess.run([irsig, "run", sweep, "--db", database], check=True)
    subprocess.run([irsig, "export", database, "--thumbnails", "--exr", "--out", pictures], check=True)
    out = []
    for label in csv.DictReader(open(pictures / "labels.csv")):
        fraction = {name: numpy.zeros((int(label["height_px"]), int(label["width_px"]))) for name in PARTS}
        for part, left, top, width, height, packed, samples in sqlite3.connect(database).execute(
                PIXELS_OF_PARTS, [int(label["row"])]):
            met = numpy.frombuffer(zlib.decompress(packed), "<u2").reshape(height, width)
            fraction[part][top:top + height, left:left + width] = met / samples
        exr = [read_exr((pictures / label["image"]).with_suffix(end))[..., 0] for end in (".exr", ".stderr.exr")]
        out.append((label, *exr, list(fraction.values())))
    return out


def make_scene(model):
    """Builds the frigate, the sensor and the world in Blender; returns the model's vertices [m]."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.obj_import(filepath=str(model), forward_axis="Y", up_axis="Z")
    scene, vertices = bpy.context.scene, []
    scene.camera = bpy.data.objects.new("sensor", bpy.data.cameras.new("sensor"))
    scene.collection.objects.link(scene.camera)
    for name in PARTS:
        mesh, material = bpy.data.objects[name].data, bpy.data.materials.new(name)
        mesh.materials.append(material)
        vertices += [tuple(vertex.co) for vertex in mesh.vertices]
        if hasattr(material.cycles, "sample_as_light"):  # before Blender 3.5: less noise where nearly all emits
            material.cycles.sample_as_light = False
        material.use_nodes = True
        tree = material.node_tree
        emission, diffuse, both = (tree.nodes.new("ShaderNode" + k) for k in ("Emission", "BsdfDiffuse", "AddShader"))
        tree.links.new(emission.outputs[0], both.inputs[0])
        tree.links.new(diffuse.outputs[0], both.inputs[1])
        tree.links.new(both.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes, scene.world.cycles.sampling_method = True, "NONE"
    tree = scene.world.node_tree
    place, axes, step = (tree.nodes.new("ShaderNode" + kind) for kind in ("TexCoord", "SeparateXYZ", "MapRange"))
    step.inputs["From Min"].default_value, step.inputs["From Max"].default_value = -1e-6, 1e-6  # at the horizon
    tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    tree.links.new(place.outputs["Generated"], axes.inputs[0])
    tree.links.new(axes.outputs["Z"], step.inputs["Value"])
    tree.links.new(step.outputs["Result"], tree.nodes["Background"].inputs["Strength"])
    cycles, render, settings = scene.cycles, scene.render, scene.render.image_settings
    render.engine, render.film_transparent, cycles.pixel_filter_type = "CYCLES", True, "BOX"
    settings.file_format, settings.color_depth, settings.color_mode = "OPEN_EXR", "32", "RGBA"
    cycles.use_adaptive_sampling = cycles.use_denoising = cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    return numpy.array(vertices)


def cycles_image(vertices, view, file, variant, seed, samples):
    """Renders a view; returns radiance [W/(m2 sr)] and coverage of each pixel, and where pixels are on the image plane.

    The camera is aimed as irsig aims its sensor: at the reference point, with square pixels over the bounding rectangle
    of the vertices, which is widened by 1e-5 and to whole pixels. Places are at unit distance from the sensor [rad]."""
    scene, (reflections, sky, lower), um = bpy.context.scene, VARIANTS[variant], numpy.linspace(*LAMBDA_UM, 4001)
    for name, (temperature_k, emissivity) in PARTS.items():
        planck = 1.191042972e8 / um**5 / numpy.expm1(14387.76877 / (um * temperature_k))
        nodes, reflectance = bpy.data.materials[name].node_tree.nodes, 1 - emissivity if reflections else 0
        nodes["Emission"].inputs["Strength"].default_value = emissivity * numpy.trapz(planck, um)
        nodes["Diffuse BSDF"].inputs["Color"].default_value = (reflectance, reflectance, reflectance, 1)
    step = scene.world.node_tree.nodes["Map Range"].inputs
    step["To Min"].default_value, step["To Max"].default_value = (um[-1] - um[0]) * lower, (um[-1] - um[0]) * sky
    (ca, sa), (ce, se) = ((math.cos(x), math.sin(x)) for x in map(math.radians, view[:2]))
    backward, up = numpy.array([ce * ca, -ce * sa, se]), numpy.array([-se * ca, se * sa, ce])
    right, q = numpy.cross(up, backward), vertices - view[2] * backward
    plane = numpy.stack([q @ right, q @ up]) / -(q @ backward)
    middle, size = (plane.max(axis=1) + plane.min(axis=1)) / 2, numpy.ptp(plane, axis=1)
    size += 2e-5 * size.max()
    pixel = size.max() / LONG_SIDE_PX
    px = numpy.ceil(size / pixel - 1e-6).astype(int)
    lens, axes = scene.camera.data, numpy.stack([right, up, backward, view[2] * backward], axis=1)
    scene.camera.matrix_world = mathutils.Matrix([*axes.tolist(), (0, 0, 0, 1)])
    scene.render.resolution_x, scene.render.resolution_y = map(int, px)
    lens.sensor_fit, lens.lens = "HORIZONTAL", lens.sensor_width / (pixel * px[0])
    lens.shift_x, lens.shift_y = middle / (pixel * px[0])
    lens.clip_start, lens.clip_end = 0.5 * view[2], 2 * view[2]
    scene.cycles.max_bounces = scene.cycles.diffuse_bounces = reflections
    scene.cycles.samples, scene.cycles.seed, scene.render.filepath = samples, seed, str(file)
    bpy.ops.render.render(write_still=True)
    image, (x, y) = read_exr(file), (middle[i] + pixel * (numpy.arange(px[i]) + 0.5 - px[i] / 2) for i in (0, 1))
    return image[..., 0], image[..., 3], x[None, :], y[::-1, None], pixel


def compare(runs, *renders):
    """Returns the numbers of a view's line in the table, and whether the view passes."""
    label, ((a, cover_a, x, y, pixel), (b, cover_b, *_)) = runs[0][0], renders
    assert abs(float(label["pixel_rad"]) / pixel - 1) < 1e-6, "irsig's pixels have another size"
    intensity_w_sr = numpy.mean([float(run[0]["intensity_w_sr"]) for run in runs])
    image, stderr, fraction = (numpy.array([run[i] for run in runs]) for i in (1, 2, 3))
    mean, mean_stderr, fraction = image.mean(axis=0), (stderr**2).sum(axis=0)**0.5 / len(runs), fraction.mean(axis=0)
    cycles, cover, seen = (a + b) / 2, (cover_a + cover_b) / 2, fraction.sum(axis=0)
    inside, noise, worst = numpy.zeros(mean.shape, bool), numpy.zeros(mean.shape), 0
    for whole in numpy.pad(fraction == 1, ((0, 0), (1, 1), (1, 1))):
        of_part = numpy.all([whole[i:i + a.shape[0], j:j + a.shape[1]] for i in range(3) for j in range(3)], axis=0)
        if of_part.sum() >= 20:
            inside, noise[of_part] = inside | of_part, ((a - b)[of_part]**2).mean()**0.5 / 2
            worst = max(worst, mean[of_part].sum() / cycles[of_part].sum() - 1, key=abs)
    edge = ((cover > 0) & (cover < 1)) | ((seen > 0) & (seen < 1))
    error, one_error = ((e**2 + noise**2)**0.5 + 1e-5 * cycles + 1e-9 for e in (mean_stderr, stderr))  # float32
    off, z, z_one = (mean[inside] / cycles[inside] - 1), ((mean - cycles) / error)[inside], (image - cycles) / one_error
    # A pixel off the axis subtends less; sums over pixels of radiance x solid angle x range^2 are intensities.
    area_m2 = (pixel * float(label["range_m"]))**2 * (1 + x**2 + y**2)**-1.5
    sums = [100 * ((area_m2 * radiance).sum() / intensity_w_sr - 1) for radiance in (mean, cycles)]
    agree, rms = ((abs(off) < 0.01) | (abs(z) < 3)).mean(), lambda v: (v**2).mean()**0.5
    return [inside.sum(), *(100 * numpy.median(e[inside] / cycles[inside]) for e in (mean_stderr, noise)),
            100 * off.mean(), 100 * numpy.median(abs(off)), 100 * rms(off), *numpy.percentile(100 * abs(off), [95, 99]),
            100 * worst, rms(z_one[:, inside]), rms(z), 100 * agree, edge.sum(), (seen - cover)[edge].mean(),
            rms((seen - cover)[edge]), rms(z_one[:, edge]), 100 * (seen.sum() / cover.sum() - 1), *sums
            ], agree >= 0.99 and abs(worst) <= 0.005


irsig, folder, *counts = sys.argv[sys.argv.index("--") + 1:]
seeds, samples = map(int, counts + ["16", "512"][len(counts):])
folder, passed = pathlib.Path(folder).resolve(), True
table = "| " + " | ".join(COLUMNS) + " |\n|" + "---|" * len(COLUMNS) + "\n"
subprocess.run([irsig, "model", "frigate", "--triangles", "20000", "--out", folder / "frigate.obj"], check=True)
vertices = make_scene(folder / "frigate.obj")
for variant in VARIANTS:
    runs = [irsig_images(irsig, folder, variant, seed) for seed in range(1, seeds + 1)]
    for number, view in enumerate(VIEWS):
        numbers, good = compare([run[number] for run in runs], *(cycles_image(
            vertices, view, folder / f"{variant}-{number}-{seed}.exr", variant, seed, samples) for seed in (1, 2)))
        passed = passed and good
        table += f"| {variant} | {view} | " + " | ".join(f"{x:.4g}" for x in numbers) + " |\n"
        (folder / "table.md").write_text(table)
sys.exit(0 if passed else 1)
