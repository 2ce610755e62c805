"""What people type wrongly, and what they are told: each message names the place and what was expected.

usage: wrong_input_test.py <irsig executable>
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

IRSIG, SOURCE = sys.argv[1], pathlib.Path(__file__).resolve().parents[2]

# What is written in place of what matches in the sweep file of `irsig init`; what is said of it. A third "warning": it
# is computed all the same.
SWEEPS = [
    (r"^temperature_k = .*", "temperature_k = 20", r"\d+:1: warning: part\[0\].temperature_k = 20 .*20 C are 293.15 K", "warning"),
    (r"^temperature_k = .*", "temperature_k = -5", r"part\[0\].temperature_k = -5, expected .*-5 C are 268.15 K"),
    (r"^relative_humidity_percent = .*", "relative_humidity_percent = 0.8", r"is it a fraction\? 80 % are", "warning"),
    (r"^relative_error = .*", "relative_error = 1", r"= 1 is 100 %: is it in percent\? 1 % are 0.01", "warning"),
    (r"^relative_error = .*", "relative_error = 2", r"relative_error = 2, expected .*is it in percent\? 2 % are 0.02"),
    (r"^relative_error = .*", "relative_error = 0", r"relative_error = 0, expected a number from 1e-06 to 1"),
    (r"^date = .*", 'date = "2025/12/21"', r'date = "2025/12/21", expected a date of the calendar: 2025-12-21'),
    (r"^time = .*", 'time = ["12:00"]', r'time\[0\] = "12:00" has no offset, expected .*"10:30\+09:00"'),
    (r"^time = .*", 'time = ["25:00+01:00"]', r"its hour must be between 00 and 23"),
    (r"^time = .*", 'time = ["12:00-09:00"]', r'time\[0\] = "12:00-09:00" is 9\.7 h behind the sun at place.longitude_deg = 10\.1: ', "warning"),
    (r"^date = .*", 'date = 2025-07-15\ntime = "12:00Z"', r'wrong\.toml:\d+:1: season\[0\]\.time does not apply: .*expected time = \["06:00'),
    (r"^lambda_min_um = 3$", "lambda_min_um = 3000", r"is it in nm\? 3000 nm are 3 um"),
    (r"^lambda_min_um = 8\nlambda_max_um = 12", "lambda_min_um = 833\nlambda_max_um = 850", r"833 cm-1 are 12\.0048 um"),
    (r"^lambda_min_um = 3\nlambda_max_um = 5", "lambda_min_um = 5\nlambda_max_um = 3", r"expected the shorter wavelength first"),
    (r"^step_um = .*", "step_um = 0.5", r"the air's table covers 2.941-15.38 um, .*expected a smaller step_um"),
    (r"^step_um = .*", "step_um = 0", r"step_um = 0, expected a number from"),
    (r"^step_um = .*", "step_um = 0.00001", r"makes more than 100000 wavelengths"),
    (r"^step_um = .*", "step_um = 0.0001", r"60002 wavelengths \(limit 10000\).*--yes"),
    (r"^latitude_deg = .*", "latitude_deg = 54.3\nvisibility_m = 20000", r'unknown key "visibility_m" in place, it is a key of .*\[air\]'),
    (r'^name = "ship"', 'name = "ship"\nair_temperature_k = 290', r'unknown key "air_temperature_k", it is a key of .*\[weather\]'),
    (r"^heading_deg", "headding_deg", r'did you mean "heading_deg"\?'),
    (r"^\[place\]", "[plase]", r'unknown key "plase", did you mean "place"\?'),
    (r'"generic_grey_paint"', '"generic_gray_paint"', r'did you mean "generic_grey_paint"\?'),
    (r'^kind = "ring"', 'kind = "rings"', r'did you mean "ring"\?'),
    (r"^aerosol = .*", 'aerosol = "sea"', r'expected one of "none", "rural"'),
    (r"^range_m = .*", "range_m = [5000, 10000]", r"viewpoints.range_m is an array, expected a number \(several: ranges_m\)"),
    (r"^range_m = .*", "range_m = 5", r"inside the target's convex hull.*5 km are 5000 m"),
    (r"^range_m = .*", 'range_m = "5 km"', r"is a string, expected a number without quotes and unit"),
    (r"^pressure_pa = .*", "pressure_pa = 1013", r"1013 hPa are 101300 Pa"),
    (r"^visibility_m = .*", "visibility_m = 23", r"23 km are 23000 m"),
    (r"^sea_temperature_k = .*", "sea_temperature_k = 14", r"is ice, expected .*14 C are 287.15 K"),
    (r"^wind_speed_m_s = .*", "wind_speed_m_s = 190", r"wind_speed_m_s = 190, expected a number from 0 to 100"),
    (r"^latitude_deg = .*", "latitude_deg = 110.1", r"latitude_deg = 110.1, expected a number from -90 to 90"),
    (r"^latitude_deg = .*", "latitude_deg = 54,3", r"numbers have a decimal point"),
    (r'^kind = "ring"\ncount = 12\nelevation_deg = .*', 'kind = "fibonacci"\ncount = 12\nelevation_min_deg = -20',
     r"wrong\.toml:\d+:\d+: .*lies under water, and \d+ more, expected sensors above the sea: a larger elevation_min_deg"),
    (r"^elevation_deg = .*", "elevation_deg = [-3, 10]", r"elevation -3, .*lies under water, and 11 more, expected sensors above the sea"),
    (r"^count = 12", "count = 20.5", r"count = 20.5, expected a whole number from 1 to 1e\+06"),
    (r"^elevation_deg = .*", "elevation_deg = [100]", r"elevation_deg\[0\] = 100, expected a number from -90 to 90"),
    (r"^count = 12", "count = 2000000", r"viewpoints, expected at most 1000000"),
    (r"^unit_m = .*", "unit_m = 0", r"unit_m = 0, expected a number from"),
    (r"^up_axis = .*", 'up_axis = "z"', r'expected one of "\+x"'),
    (r"^file = .*", 'file = "shipp.obj"', r'model.file "shipp.obj": No such file'),
    (r"^reference = .*", 'reference = "origin"\ndraft_m = -3', r"draft_m = -3, expected .*offset_m"),
    (r"^reference = .*", 'reference = "origin"\ndraft_m = 60', r"model.draft_m: all of the target lies below the waterline"),
    (r"^reference = .*", 'reference = "origin"\ndraft_m = 39', r"lie below the waterline", "warning"),
    (r'^name = "summer"', 'name = "sumer"', r'did you mean "summer"\?', "warning"),
    (r"^date = .*", "date = 1025-07-15", r"expected a year from 1900 to 2100"),
    (r"^air_temperature_k = .*", "air_temperature_k = 19", r"is it in C\? 19 C are 292.15 K"),
    (r"^sun = true", 'sun = "yes"', r"transport.sun is a string, expected true or false"),
    (r"^\[\[season\]\]", '[[part]]\nname = "x"\nmatch = ["hull"]\nmaterial = "generic_grey_paint"\ntemperature_k = 300\n\n[[season]]',
     r'group "hull" of the model already belongs to part "hull"'),
    # Another unit, in the key.
    (r"^air_temperature_k = .*", "air_temperature_c = 20", r'unknown key "air_temperature_c" in weather, expected "air_temperature_k" \(20 C are'),
    (r"^range_m = .*", "range_km = 5", r'unknown key "range_km" in viewpoints, expected "range_m" \(5 km are 5000 m\)'),
    (r"^wind_speed_m_s = .*", "wind_speed_kn = 10", r'expected "wind_speed_m_s" \(10 kn are 5.144 m/s\)'),
    (r"^lambda_min_um = 3\nlambda_max_um = 5", 'lambda_um = "3-5um"',
     r'unknown key "lambda_um" in band\[0\], expected "lambda_m.._um", "lambda_m.._um"'),
    (r"^heading_deg = .*", "heading_deg = 400", r"heading_deg = 400, expected a number from -360 to 360"),
    # Case, and the wrong table.
    (r"^latitude_deg", "Latitude_deg", r'unknown key "Latitude_deg" in place, did you mean "latitude_deg"\?'),
    (r"^\[place\]", "[PLACE]", r'unknown key "PLACE", did you mean "place"\?'),
    (r'^kind = "ring"', 'kind = "RING"', r'viewpoints.kind = "RING": did you mean "ring"\?'),
    (r"^count = 12", "count = 12\nrelative_error = 0.01", r'unknown key "relative_error" in viewpoints, it is a key of .*\[accuracy\]'),
    (r"^\[\[season\]\]", "[season]", r"season is a table, expected an array of tables: \[\[season\]\]"),
    # Fractions.
    (r"^\[place\]", '[[material]]\nname = "grey"\nkind = "lambert"\nemissivity = 90\n\n[place]',
     r"emissivity = 90, expected a number from 0 to 1 .*is it in percent\? 90 % are 0.9"),
    (r"^\[place\]", '[[material]]\nname = "grey"\nkind = "lambert"\nemissivity = -0.9\n\n[place]',
     r"emissivity = -0.9, expected a number from 0 to 1"),
    # Times and files.
    (r"^time = .*", "time = [12:00:00]", r'time\[0\] is a time, expected a time of day with its offset from UTC, in quotes'),
    (r"^date = .*", "date = 2025-02-30", r"expected day between 1 and 28 \(inclusive\), saw 30"),
    (r"^wind_speed_m_s = .*", "", r"wind_speed_m_s is missing, expected the wind 10 m above the surface"),
    (r"^file = .*", "file = 'models\\ship.obj'", r'model.file "models\\ship.obj": No such file .*has a backslash, expected "/"'),
    (r"^file = .*", 'file = "."', r'model.file ".": is a folder, expected a regular file'),
    # The grammar of TOML.
    (r'^kind = "ring"', 'kind = "ring', r"wrong\.toml:\d+:\d+: .*\(the closing quote of this text is missing\)"),
    (r'^kind = "ring"', "kind = ring", r'text stands in "straight quotes"'),
    (r"^sun = .*", "sun = yes", r"\(a switch is true or false, in lower case and without quotes\)"),
    (r"^sun = .*", "sun = True", r"\(a switch is true or false, in lower case and without quotes\)"),
    (r"^range_m = .*", "range_m = 5 km", r"\(a number stands alone, without its unit\)"),
    (r"^range_m = .*", "range_m = 5000;", r"\(a line ends without a semicolon\)"),
    (r"^range_m = .*", "range_m = 5000 // far", r"\(a remark begins with #\)"),
    (r"^range_m = .*", "range_m: 5000", r"expected '=', saw ':' \(KEY = VALUE\)"),
    (r"^range_m = .*", "range_m = 5000\nrange_m = 6000", r"\(each key stands once in its table: delete one\)"),
    (r"^relative_error = .*", "relative_error = 1%", r"\(a fraction: 1 % is 0.01\)"),
    (r"^relative_error = .*", "relative_error = .01", r"\(a number begins with a digit: 0.01\)"),
    # Clouds.
    (r'^name = "summer"', 'name = "summer"\ncloud_cover = 80', r"cloud_cover = 80, expected a number from 0 to 1 .*80 % are 0.8"),
    (r'^name = "summer"', 'name = "summer"\ncloud_cover = 0.5', r"taken as stratus, 670 m thick, .*set cloud_type or", "warning"),
    (r'^name = "summer"', 'name = "summer"\ncloud_type = "stratus"', r":\d+:1: season\[0\]\.cloud_type does not apply without a cover, "
     r"expected cloud_cover = 0 to 1 beside it"),
    (r'^name = "summer"', 'name = "summer"\ncloud_cover = 0.5\ncloud = [{type = "stratus", cover = 1}]',
     r"cloud_cover does not apply beside \[\[season\.cloud\]\], .*expected only one of them"),
    (r'^name = "summer"[\s\S]*^model = "atmosphere"', 'name = "summer"\ncloud_cover = 1\n\n[air]\nmodel = "vacuum"',
     r'cloud_cover does not apply to air.model "vacuum", which has no clouds: expected air.model = "atmosphere"'),
    *((r"\Z", f"\n[[season.cloud]]\n{keys}\n", said) for keys, said in (
        ('type = "stratus"\ncover = 0.5\ncover_oktas = 4', r"cover_oktas = 4 and cover = 0.5 both .*expected only one of them"),
        ('type = "stratus"\ncover_oktas = 9', r"cover_oktas = 9, expected a number from 0 to 8 \(eighths of the sky\)"),
        ('type = "stratus"\ncover = 1\nbase_m = 900\ntop_m = 200',
         r"cloud\[0\]\.top_m: the layer's top, 200 m, is below its base, 900 m; expected top_m of at least 901 m"),
        ('type = "altostratus"\ncover = 1\ntop_m = 900', r'is below its base, 2400 m \(of type "altostratus"\)'),
        ('type = "cirrus"\ncover = 1\nbase_m = 24500', r"cloud\[0\]\.base_m: the layer's top, 25500 m .*is above 25000 m"),
        ('type = "stratus"\ncover = 1\nphase = "ice"',
         r':\d+:1: .*cloud\[0\]\.phase = "ice" contradicts type "stratus", whose droplets have .* 7.9 um: '
         r'expected effective_radius_um beside it, or phase = "water"'),
        ('type = "cirrus"\ncover = 1\nphase = "water"', r'cloud\[0\]\.phase = "water" contradicts type "cirrus", whose crystals'),
        ('type = "stratos"\ncover = 1', r'cloud\[0\]\.type = "stratos": did you mean "stratus"\?'),
        ('type = "fog"\ncover = 1', r'cloud\[0\]\.type = "fog": expected one of "stratus", "stratocumulus"'),
        ('type = "cirrus"\ncover = 1\neffective_radius_um = 5',
         r'effective_radius_um = 5 um is outside the table of ice crystals, expected 6.4 to 153.3 um, or phase = "water"'),
        ('type = "stratus"', r"cloud\[0\]\.cover is missing, expected the covered fraction of the sky"),
        ("cover = 1", r'cloud\[0\]\.type is missing, expected a type \("stratus", .*also season\[0\]\.cloud\[0\]\.base_m'),
        ('type = "stratus"\ncover = 1\n[[season.cloud]]\ntype = "cirrus"\ncover = 0.5',
         r"cloud\[1\] is a second layer of cloud, expected one"))),
    (r"\Z", '\n[season.cloud]\ntype = "stratus"\n', r"cloud is a table, expected an array of tables: \[\[season\.cloud\]\]"),
    (r"\Z", '\n[[cloud]]\ntype = "stratus"\n', r'unknown key "cloud", expected \[\[season\.cloud\]\], \[\[condition\.cloud\]\]'),
    (r"^aerosol = .*", 'aerosol = "maritime"\ncloud_cover = 0.5', r'unknown key "cloud_cover" in air, it is a key of .*\[\[season\]\]'),
]

# The same of a sweep with land, objects and maps: jobs/examples/vehicle_village.toml.
LAND = [
    (r"^heights = .*", 'heights = "land/hights.asc"', r'land.heights = "land/hights.asc": No such file'),
    (r"^heights = .*\n", "", r"land.heights is missing, expected a file of heights: .hgt, .tif, .tiff or .asc"),
    (r"^heights = .*", 'heights = "models/vehicle.obj"', r"expected a file that ends in .hgt, .tif, .tiff or .asc"),
    (r"^heights = .*", 'heights = "land/heights.asc"\nepsg = 25832', r"land.epsg = 25832: .*gdalwarp -t_srs EPSG:326ZZ"),
    (r"^heights = .*", 'heights = "land/heights.asc"\nepsg = 4326',
     r"land.heights: its coordinates begin at x = .*no degrees of longitude and latitude .*state the code of its UTM zone, or none"),
    (r"^heights = .*", 'heights = "land/heights.asc"\nwidth_m = 20', r"has no cell of 20 m; expected a smaller spacing"),
    (r"^heights = .*", 'heights = "land/heights.asc"\nwidth_km = 2', r'unknown key "width_km" in land, expected "width_m" \(5 km are 5000 m\)'),
    (r"^heights = .*", 'heights = "land/heights.asc"\nspacing_m = 0.01', r"land.spacing_m = 0.01, expected a number from 0.1 to 10000 \(stones"),
    (r'^fraction_file = "land/grass.asc"', 'fraction_file = "land/gras.asc"', r'fraction_file = "land/gras.asc": No such file'),
    (r'^fraction_file = "land/(grass|wheat).asc"\n', "", r"fraction_file is missing, .*expected at most one material without a file"),
    (r'^fraction_file = "land/wheat.asc"', 'fraction_file = "land/grass.asc"',
     r"the fractions of all materials at row \d+, column \d+ .* add up to .* = 2, expected 1 within 1/64; correct the maps, or leave out"),
    (r'^material = "grass"', 'material = "gras"', r'land.material\[0\].material = "gras" is no known material: did you mean "grass"\?'),
    (r"^wheat = 308\n", "", r'land.material\[1\].temperature_k is missing in season "day", expected .*or \[heat\], which computes it'),
    (r"^wheat = 308", "weat = 308", r'land_temperature_k.weat: the land has no material "weat", did you mean "wheat"\?'),
    (r"^grass = 302", "grass = 29", r"land_temperature_k.grass = 29, expected a number from 150 to 1500 .*29 C are 302.15 K"),
    (r'^material = "brick"\nobjects_only = true', 'material = "brick"\nobjects_only = "yes"', r"objects_only is a string, expected true or false"),
    (r'^\[\[land.material\]\]\nmaterial = "brick"', '[land.material]\nmaterial = "brick"', r"another one of a kind is \[\[in two brackets\]\]"),
    (r'^material = "brick"\npart', 'material = "bricks"\npart', r'land.object\[0\].material = "bricks" is no \[\[land.material\]\], did you mean "brick"\?'),
    (r'match = "roof"', 'match = "rooof"', r'part\[0\].match: "rooof" matches no group of the model .*its groups are: "walls", "roof"'),
    (r'material = "concrete" \}', 'materiel = "concrete" }', r'unknown key "materiel" in land.object\[0\].part\[0\], did you mean "material"\?'),
    (r'"land/village.csv"', '"land/vilage.csv"', r'places_file = "land/vilage.csv": No such file'),
    (r'"land/village.csv"', '"land/heights.asc"', r'places_file = "land/heights.asc", expected a file that ends in .csv'),
    (r"^count = 2000", "count = 2000000", r"land.object\[2\].count = 2e\+06, expected a number from 1 to 1e\+06"),
    (r"^count = 2000\n", "count = 2000\nplace = [{east_m = 3, north_m = 4}]\n", r"count is stated beside place, expected only one of \"place\", \"places_file\", \"count\""),
    (r'^within = "grass"', 'within = "brick"', r'within = "brick" is no \[\[land.material\]\] that covers ground, expected one of "grass"'),
    (r"^inner_radius_m = 100", "inner_radius_m = 900", r"inner_radius_m = 900 is not below radius_m = 700, expected a ring"),
    (r"^scale = 0.6", "scale = 0", r"scale = 0, expected a number from 0.001 to 1000"),
    (r"\{ east_m = -6, north_m = -14 \}", "{ east = -6, north = -14 }", r'unknown key "east" in land.object\[1\].place\[0\], expected one of "east_m"'),
    (r"\{ east_m = -6, north_m = -14 \}", "{ east_m = -6000, north_m = -14 }", r"stands beyond the map of heights; move it, or use a larger map"),
    (r'^kind = "ground"', 'kind = "sea"\nsea_model = "cox_munk"', r'surroundings.kind = "sea" does not go with \[land\], expected kind = "ground"'),
    (r'^model = "models/house.obj"\nunit_m = 1\n', 'model = "models/house.obj"\n', r"unit_m is missing, expected the length of one unit .*0.001 for millimetres"),
    (r"^elevation_deg = \[18\]", "elevation_deg = [-2]", r"lies under the ground, and 11 more, expected sensors above it"),
]

# The same of the sweep of `irsig init` with this table at its end.
IMAGE = """
[image]
kind = "camera"
pixels = [64, 48]
field_of_view_deg = 3
pixel_error_percent = 2
layers = ["at_sensor", "range"]
"""
IMAGES = [
    (r"^pixels = .*", "pixels = 320", r"image.pixels is an integer, expected an array"),
    (r"^pixels = .*", 'pixels = "320x256"', r"image.pixels is a string, expected an array"),
    (r"^pixels = .*\n", "", r"image.pixels is missing, expected \[width, height\]"),
    (r"^pixels = .*", "pixels = [32000, 256]", r"image.pixels\[0\] = 32000, expected a number from 1 to 4096"),
    (r"^field_of_view_deg = .*\n", "", r"image.field_of_view_deg is missing, expected what the width of the image subtends"),
    (r"^field_of_view_deg = .*", "field_of_view_mrad = 32", r'unknown key "field_of_view_mrad" in image, expected "field_of_view_deg" \(10 mrad are'),
    (r"^field_of_view_deg = .*", "field_of_view_deg = 200", r"field_of_view_deg = 200, expected a number from 1e-06 to 120"),
    (r'^kind = "camera"', 'kind = "cammera"', r'image.kind = "cammera": did you mean "camera"\?'),
    (r'^kind = "camera"', 'kind = "framed"', r'field_of_view_deg belongs to a camera, expected kind = "camera", or delete it'),
    (r"^pixel_error_percent = .*", "samples = 100", r"image.samples = 100, expected a power of two: 64 or 128"),
    (r"^pixel_error_percent = .*", "pixel_error_percent = 2\nsamples = 64", r"samples does not apply where the error of a pixel is asked for: delete it, or limit"),
    (r"^pixel_error_percent = .*", "pixel_error_percent = 2\npixel_error_k = 0.1", r"pixel_error_k is stated beside pixel_error_percent, expected only one of"),
    (r"^pixel_error_percent = .*", 'pixel_error_percent = "2 %"', r"pixel_error_percent is a string, expected a number without quotes and unit"),
    (r'"range"\]', '"depth"]', r'image.layers\[1\] = "depth": there is no such layer, expected one of "emitted"'),
    (r'"range"\]', '"land_sun"]', r'image.layers has "land_sun", but the sweep has no \[land\]: leave it out'),
    (r'"range"\]', '"at_sensor"]', r'image.layers\[1\] = "at_sensor" is there twice: delete one'),
    (r"^\[image\]", "[output]\nthumbnail_px = 64\n\n[image]", r"output.thumbnail_px is stated beside \[image\], expected only one of them"),
    (r"^\[image\]", "[[image]]", r"image is an array, expected a table: \[image\]"),
    (r"^\[image\]", "[images]", r'unknown key "images", did you mean "image"\?'),
    (r"\Z", "look_at_m = [1, 2]\n", r"look_at_m has 2 numbers, expected three: x forward, y starboard, z down"),
    (r"\Z", "margin = 0.1\n", r'image.margin belongs to a framed image, expected kind = "framed", or delete it'),
]

# The same of jobs/examples/imagers/mwir.toml, as `export --imager` reads it.
IMAGERS = [
    (r"^f_number = .*", "f_number = 0", r"optics.f_number = 0, expected a number from 0.1 to 1000"),
    (r"^f_number = .*", 'f_number = "f/2"', r"optics.f_number is a string, expected a number without quotes and unit"),
    (r"^aperture_m = .*", "aperture_mm = 12.5", r'unknown key "aperture_mm" in optics, expected "aperture_m" \(5 mm are 0.005 m\)'),
    (r"^aperture_m = .*", "aperture_m = 125", r"optics.aperture_m = 125, expected .*is it in mm\? 125 mm are 0.125 m"),
    (r"^pitch_m = .*", "pitch_m = 15", r"detector.pitch_m = 15, expected .*is it in um\? 15 um are 1.5e-05 m"),
    (r"^pitch_m = .*", "pitch_um = 15", r'unknown key "pitch_um" in detector, expected "pitch_m" \(15 um are 1.5e-05 m\)'),
    (r"^netd_k = .*", "netd_mk = 25", r'unknown key "netd_mk" in detector, expected "netd_k" \(25 mK are 0.025 K\)'),
    (r"^fill_factor = .*", "fill_factor = 90", r"detector.fill_factor = 90, expected a number from 0.01 to 1"),
    (r"^bits = .*", "bits = 32", r"counts.bits = 32, expected a number from 8 to 16 \(the depth of a grey PNG\)"),
    (r"^black_k = .*", "black_k = 500", r"counts.white_k = 400, expected more than black_k = 500"),
    (r"^black_k = .*", "black_k = -20", r"counts.black_k = -20, expected .*is it in C\? -20 C are 253.15 K"),
    (r"^\[optics\]", "[lens]", r'unknown key "lens", expected one of "name", "optics", "detector", "counts"'),
    (r"^\[counts\]", "[[counts]]", r"counts is an array, expected a table: \[counts\]"),
    (r"\Z", "\ncounts_per_w_m2_sr = 1e4\n", r"counts states two gains, expected black_k and white_k, or counts_per_w_m2_sr"),
]

# Commands, with what is said.
COMMANDS = [
    ([], r"a command is missing, expected one of init, run"),
    (["runn", "ship.toml"], r'unknown command "runn", did you mean "run"\?'),
    (["nosuch", "--help"], r'unknown command "nosuch"'),
    (["--help", "nosuch"], r'unknown command "nosuch"'),
    (["model", "chek", "ship.obj"], r'"chek", expected one of disk,.*; or a command, particles, plume, terrain or check'),
    (["run", "ship.toml"], r"--db is required"),
    (["run", "few.sigdb", "--db", "x.sigdb"], r"few.sigdb: this is a database, expected a sweep file"),
    (["plan", "ship.toml", "--relative-error", "1%"], r"--relative-error = 1%, expected a number without a unit \(1 % is 0.01\)"),
    (["query", "DB", "--csv", "--out", "few.sigdb"], r"does not write .sigdb files"),
    (["query", "DB", "--csv", "--out", "copy"], r"cannot write copy: it is a database, expected another name"),
    (["plot", "DB", "--kind", "polar", "--out", "ship.toml"], r"does not write .toml files"),
    (["model", "check", "ship.obj", "--repair", "ship.obj"], r"this is the model itself, expected another name"),
    (["model", "check", "ship.obj", "--repair", "x.stl"], r"the copy is OBJ"),
    (["query", "DB", "--at-range-m", "999"], r"no viewpoint at 999 m in this database; there is: \d+ m"),
    (["run", "nothere.toml", "--db", "x.sigdb"], r"nothere.toml: No such file"),
    (["run", "ship.obj", "--db", "x.sigdb"], r"this is a model, expected a sweep file: `irsig init --model ship.obj`"),
    (["run", "ship.toml", "--db", "nofolder/x.sigdb"], r"nofolder/x.sigdb: cannot be written"),
    (["run", "ship.toml", "--db", "x.sigdb", "--relative-error", "1e-9"], r"--relative-error: .*expected a number from 1e-06"),
    (["init"], r"--model is required"),
    (["init", "--model", "ship.toml"], r"expected .obj, .ply, .stl, .gltf or .glb"),
    (["init", "--model", "ship.obj", "--place", "54"], r"expected LAT,LON in degrees"),
    (["query", "ship.toml"], r"is not a signature database"),
    (["query", "DB", "--seasn", "winter"], r'--seasn: did you mean "--season"\?'),
    (["query", "DB", "--season", "wintr"], r'no season "wintr" in this database; there is: summer'),
    (["query", "DB", "--season", "summer", "--season", "wintr"], r'no season "wintr" in this database; there is: summer'),
    (["query", "DB", "--aspect", "45,10"], r"exactly one of --nearest N, --within DEG and --interpolate"),
    (["query", "DB", "--aspect", "45 10", "--nearest", "1"], r"expected AZ,EL in degrees"),
    (["query", "DB", "--sort", "beauty"], r'no column "beauty" to sort by'),
    (["query", "DB", "--format", "xml"], r"--format xml: expected one of text, csv, json"),
    (["query", "DB", "--csv", "--json"], r"--csv excludes --json"),
    (["query", "DB", "--csv", "--out", "a.json"], r"the name ends as json, but --format is csv"),
    (["query", "DB", "--parts", "--quantity", "contrast_intensity"], r"only their source intensity is stored"),
    (["query", "DB", "--row", "1", "--thumbnail", "a.bmp"], r"expected a name that ends in .png or .exr"),
    (["query", "DB", "--row", "1", "--thumbnail", "a.png", "--thumbnail-scale", "9,1"], r"expected common, or BLACK,WHITE"),
    (["query", "DB", "--time", "2025/12/21"], r"expected RFC 3339 with offset"),
    (["explain", "DB", "--row", "9999"], r"no row 9999 in this database; the last one is"),
    (["plot", "DB", "--kind", "polar", "--out", "a.png"], r"does not write .png files, expected svg"),
    (["plot", "DB", "--kind", "map", "--out", "a.csv"], r"--kind map is drawn as svg alone"),
    (["plot", "DB", "--kind", "hours", "--out", "a.svg"], r"one viewpoint of one sweep: choose it with --aspect"),
    (["plot", "DB", "--kind", "hours", "--row", "1", "--out", "a.svg"], r"needs two times or more of a day"),
    (["plot", "DB", "--kind", "hours", "--region", "bow=0,0,1,1", "--out", "a.svg"], r"--region belongs to --kind regions"),
    (["plot", "DB", "--kind", "regions", "--region", "bow=0,0,1", "--out", "a.svg"], r"expected NAME=x0,y0,x1,y1 in whole pixels"),
    (["plot", "DB", "--kind", "regions", "--region", "bow=0,0,1,1", "--region", "bow=1,0,2,1", "--out", "a.svg"],
     r"a region bow is given before; give each a name of its own"),
    (["plot", "DB", "--kind", "regions", "--out", "a.svg"], r"one viewpoint of one sweep: choose it with --aspect \(the nearest\)"),
    (["plot", "DB", "--kind", "regions", "--row", "1", "--out", "a.svg"], r"needs two times or more of a day"),
    (["plot", "DB", "--kind", "regions", "--row", "1", "--layer", "range", "--out", "a.svg"], r"--layer range: .*expected one of emitted"),
    (["plot", "DB", "--kind", "map", "--scale", "1,2", "--out", "a.svg"], r"--scale belongs to --kind picture or sheet or temperatures"),
    (["plot", "DB", "--kind", "picture", "--row", "1", "--scale", "2,1", "--out", "a.svg"], r"expected LOW,HIGH, the smaller one first"),
    (["plot", "DB", "--kind", "temperatures", "--out", "a.svg"], r"needs --aspect AZ,EL, or the --row of a signature"),
    (["plot", "DB", "--kind", "temperatures", "--row", "1", "--band", "lwir", "--out", "a.svg"], r"and no other filter"),
    (["plot", "DB", "--kind", "temperatures", "--row", "1", "--pixels", "9999", "--out", "a.svg"], r"--pixels"),
    (["plot", "DB", "--kind", "sky", "--out", "a.svg"], r"a picture of the sky is of one band, choose it with --band: mwir, lwir"),
    (["plot", "DB", "--kind", "sky", "--band", "lwir", "--season", "wintr", "--out", "a.svg"], r'no season "wintr" in this database; there is: summer'),
    (["plot", "DB", "--kind", "sky", "--row", "1", "--elevation", "3", "--out", "a.svg"], r"--elevation belongs to --kind polar"),
    (["plot", "DB", "--kind", "sky", "--band", "lwir", "--aspect", "0,5", "--nearest", "1", "--out", "a.svg"],
     r"the sky is of a condition, .*and no other filter"),
    (["plot", "DB", "--kind", "pie", "--out", "a.svg"], r"--kind pie: expected one of polar, "),
    (["export", "DB", "--out", "a.xlsx"], r"does not write .xlsx files, expected csv, netcdf, envi, tsf, thumbnails, temperatures"),
    (["export", "DB", "--netcdf", "--out", "-"], r"netcdf needs a file"),
    (["model", "tank", "--triangles", "100", "--out", "x.obj"], r'model "tank", expected one of disk, sphere'),
    (["model", "box", "--triangles", "12", "--out", "x.stl"], r"does not write .stl files, expected obj"),
    (["material", "show", "gold paint"], r'no material is called "gold paint": expected one of'),
    (["status", "--coordinator", "tcp"], r"expected unix:PATH, or HOST:PORT with TLS"),
    (["QUERY", "DB"], r'unknown command "QUERY", did you mean "query"\?'),
    (["help", "--season"], r"help --season: expected a command before it, as in irsig help query"),
    (["help", "qurey"], r'unknown command "qurey", did you mean "query"\?'),
    (["query", "DB", "--band", "lwir", "--band", "mwir"], r"--band is given more than once, expected one value"),
    (["query", "DB", "-band", "lwir"], r'-band: did you mean "--band"\?'),
    (["query", "DB", "--row", "-1"], r"--row: -1 is not a number above 0"),
    (["query", "."], r"\.: is a directory"),
    (["query", "DB", "-o", "a.xlsx"], r"--out a.xlsx: this command does not write .xlsx files"),
    (["query", "DB", "--csv", "-o", "nofolder/a.csv"], r"cannot write nofolder/a.csv: No such file"),
    (["plan", "C:\\ship.toml"], r'C:\\ship.toml: No such file or directory: the name has a backslash, expected "/"'),
    (["compare", "DB"], r"compare needs what to compare with: a second database, or --b-sweep"),
    (["compare", "DB", "--band", "mwir", "--b-band", "lwir"],
     r"mwir \(3 to 5 um\) and lwir \(8 to 12 um\) are bands of different limits or responses.*choose the same band for both"),
    (["fly"], r"SWEEP is required"),
    (["fly", "nothere.toml"], r"nothere.toml: No such file"),
    (["fly", "DB"], r"few.sigdb: this is a database, expected a sweep file"),
    (["fly", "ship.toml", "--port", "80000"], r"--port 80000: expected 0 \(a free one\) to 65535"),
    (["fly", "ship.toml", "--address", "0.0.0.0"], r"--address 0.0.0.0: irsig fly listens on this machine alone, expected 127.0.0.1"),
    (["fly", "ship.toml", "--threads", "0"], r"--threads 0: expected 1 to 256"),
    (["fly", "ship.toml", "--film", "day.gif"], r"--film day.gif: the film is an animated PNG, expected a name that ends in .png or .apng"),
    (["fly", "ship.toml", "--keep", "ship.toml"], r"ship.toml: is not a signature database"),
    (["serve", "ship.toml"], r"ship.toml: is not a signature database: `irsig run ship.toml --db NAME.sigdb` computes one"),
    (["run", "ship.toml", "--db", "x.sigdb", "--workers", "0"], r"--workers 0: expected 1 to 4096"),
    (["run", "ship.toml", "--db", "x.sigdb", "--launcher", "slrm"], r"--launcher slrm: expected one of local, slurm; did you mean slurm\?"),
    (["query", "DB", "--window", "3"], r"--window needs 2 values, 1 given"),
    (["bands", "DB", "--detector", "table.csv"], r"table.csv:1:1: this is a table, expected a detector file \(.toml\) that names it with response_file"),
    (["bands", "DB"], r"Exactly 1 option from \[--detector,--nei\] is required"),
    (["model", "check", "land/heights.asc", "--repair", "x.obj"], r"--repair: this is a map of heights, expected a model"),
    (["model", "terrain", "--map-layer", "height", "--out", "x.asc"], r"--map-layer height: expected one of heights, asphalt, .*did you mean heights\?"),
    (["export", "DB", "--thumbnails", "--imager", "nothere.toml", "--out", "x"], r"nothere.toml:1:1: No such file"),
    (["export", "DB", "--csv", "--imager", "ship.toml", "--out", "x.csv"], r"--imager: belongs to the format thumbnails"),
    (["completion", "fish"], r"SHELL fish: expected one of bash, zsh"),
    # Twenty more of new users.
    (["run", "ship.toml", "x.sigdb"], r"--db is required; not expected: x.sigdb"),
    (["run", "ship.toml", "--output", "x.sigdb"], r"--db is required; not expected: --output x.sigdb"),
    (["run", "ship.toml", "--db", "x.sigdb", "--worker", "2"], r'not expected: --worker 2\n +--worker: did you mean "--workers"\?'),
    (["init", "ship.obj"], r"--model is required; not expected: ship.obj"),
    (["explain", "DB", "5"], r"--row is required; not expected: 5"),
    (["plot", "DB", "polar", "a.svg"], r"--out is required; .*not expected: polar a.svg\n +a.svg: expected --out before a file to write"),
    (["query", "DB", "--csv", "out.csv"], r"not expected: out.csv\n +out.csv: expected --out before a file to write"),
    (["query", "DB", "copy"], r"\Airsig: not expected: copy \("),
    (["query", "DB", "--format", "excel"], r"--format excel: expected one of text, csv, json \("),
    (["query", "DB", "--range-m", "5km"], r"--range-m = 5km, expected a number without a unit \(--help"),
    (["query", "DB", "--band", "LWIR"], r'no band "LWIR" in this database; there is: lwir, mwir; did you mean "lwir"\?'),
    (["query", "DB", "--season", "Summer"], r'no season "Summer" in this database; there is: summer; did you mean "summer"\?'),
    (["query", "DB", "--quantity", "contrast"], r"--quantity contrast: expected one of .*did you mean contrast_intensity\?"),
    (["query", "DB", "--row"], r"--row needs a value"),
    (["compare", "DB", "DB", "--b-season"], r"--b-season needs a value"),
    (["serve", "DB", "--port", "http"], r"--port = http, expected a number \(--help"),
    (["bands", "DB", "--nei", "1e-9", "--band", "mwir", "--window", "3-4"], r"--window = 3-4, expected a number, or several with commas between"),
    (["bands", "DB", "--nei", "1e-9"], r'rows of several bands match, "mwir" and "lwir": choose one with --band'),
    (["export", "DB", "--coco", "--out", "images"], r"--coco: belongs to the format thumbnails, expected --thumbnails beside it"),
    (["plot", "DB", "--kind", "spectrum", "--out", "a.svg"], r"choose it with --row K, or with --aspect AZ,EL --nearest 1 or --interpolate"),
    (["plan", "ship.toml", "--relative-error", "two"], r"--relative-error = two, expected a number \(--help"),
    (["plan", "ship.toml", "--db", "ship.toml"], r"\A(irsig: )?ship.toml: is not a signature database"),
    (["show", "sky", "--height-m", "10"], r"--height-m: this option of `irsig show sky` is called --altitude-m"),
]


class WrongInput(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = pathlib.Path(folder.name)
        cls.irsig("model", "frigate", "--triangles", 2000, "--out", "ship.obj")
        cls.irsig("init", "--model", "ship.obj", "--place", "54.3,10.1", "--out", "ship.toml")
        cls.sweep = (cls.path / "ship.toml").read_text()
        few = cls.sweep.replace("count = 12", "count = 2").replace("step_um = 0.1", "step_um = 0.11")
        (cls.path / "few.toml").write_text(few + "\n[output]\nthumbnail_px = 32\n")
        cls.irsig("run", "few.toml", "--db", "few.sigdb", "--relative-error", 0.1)
        shutil.copytree(SOURCE / "jobs/examples/land", cls.path / "land")
        shutil.copytree(SOURCE / "jobs/models", cls.path / "models")
        (cls.path / "table.csv").write_text("lambda_um,response\n3,1\n5,1\n")
        (cls.path / "copy").write_bytes((cls.path / "few.sigdb").read_bytes())

    @classmethod
    def irsig(cls, *arguments, code=0):
        done = subprocess.run([IRSIG, *map(str, arguments)], cwd=cls.path, capture_output=True, text=True, timeout=300)
        assert done.returncode == code, f"{arguments}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
        return done

    def refused(self, mistakes, text, command, name):
        """Each mistake is made in the text alone, and refused with its place and its message."""
        for pattern, changed, said in mistakes:
            with self.subTest(changed or pattern):
                wrong, count = re.subn(pattern, lambda _: changed, text, flags=re.M)
                self.assertGreater(count, 0, pattern)
                (self.path / name).write_text(wrong)
                found = self.irsig(*command, code=2).stderr
                self.assertRegex(found, said)
                self.assertRegex(found, rf"(?m)^{re.escape(name)}:\d+:\d+: ")

    def test_sweep_files(self):
        self.assertGreater(len(SWEEPS) + len(LAND) + len(IMAGES) + len(IMAGERS), 150)
        for pattern, text, said, *kind in SWEEPS:
            with self.subTest(text):
                changed, count = re.subn(pattern, lambda _: text, self.sweep, flags=re.M)
                self.assertGreater(count, 0, pattern)
                (self.path / "wrong.toml").write_text(changed)
                if kind:  # said before anything is computed: a row is enough
                    changed = changed.replace("count = 12", "count = 1")
                    (self.path / "wrong.toml").write_text(changed)
                found = self.irsig("plan", "wrong.toml", code=0 if kind else 2).stderr
                self.assertRegex(found, said)
                if "limit 10000" not in said:
                    self.assertRegex(found, r"(?m)^wrong\.toml:\d+:\d+: ")

    def test_land(self):
        village = (SOURCE / "jobs/examples/vehicle_village.toml").read_text().replace("../models/", "models/")
        self.refused(LAND, village, ("plan", "village.toml"), "village.toml")

    def test_images(self):
        self.refused(IMAGES, self.sweep + IMAGE, ("plan", "images.toml"), "images.toml")

    def test_imagers(self):
        imager = (SOURCE / "jobs/examples/imagers/mwir.toml").read_text()
        self.refused(IMAGERS, imager, ("export", "few.sigdb", "--thumbnails", "--imager", "imager.toml", "--out", "x"), "imager.toml")

    def test_commands(self):
        before = sorted(p.name for p in self.path.iterdir())
        for arguments, said in COMMANDS:
            with self.subTest(" ".join(arguments)):
                words = ["few.sigdb" if a == "DB" else a for a in arguments]
                self.assertRegex(self.irsig(*words, code=2).stderr, said)
        self.assertEqual(before, sorted(p.name for p in self.path.iterdir()), "something was left behind")
        self.assertEqual((self.path / "copy").read_bytes()[:15], b"SQLite format 3")

    def test_help(self):
        self.assertEqual(self.irsig("help").stdout, self.irsig("--help").stdout)
        self.assertRegex(self.irsig("help").stdout, r"(?m)^ +help +print this help, or that of a command: irsig help query$")
        self.assertEqual(self.irsig("help", "query").stdout, self.irsig("query", "--help").stdout)
        self.assertEqual(self.irsig("help", "query", "--season").stdout, self.irsig("query", "--help").stdout)
        self.assertEqual(self.irsig("help", "model", "check").stdout, self.irsig("model", "check", "--help").stdout)
        self.assertIn("-o,--out FILE", self.irsig("help", "query").stdout)
        groups = re.findall(r"(?m)^(Start|Look|Use|Farm|Check|Reference):$", self.irsig("help").stdout)
        self.assertEqual(groups, ["Start", "Look", "Use", "Farm", "Check", "Reference"])

    def test_help_and_man_pages_are_for_people(self):
        """No notation of the parser, no line beyond the window, a man page for each command, which says the same."""
        (self.path / "man").mkdir()
        self.irsig("manual", "man", "--out", "man")
        pages = sorted((self.path / "man").glob("*.1"))
        self.assertGreater(len(pages), 45)
        for page in pages:
            with self.subTest(page.name):
                text = page.read_text()
                for head in ('.TH "', ".SH NAME", ".SH SYNOPSIS", ".SH DESCRIPTION", '.SH "EXIT STATUS"'):
                    self.assertEqual(text.count(head), 1, head)
                shown = self.irsig("help", *page.stem.replace("verify-effects", "verify_effects").replace("-", " ").replace("_", "-").split()[1:]).stdout
                for found in (text, shown):
                    self.assertNotRegex(found, r"UINT|FLOAT|POSITIVE|:INT|INT in \[|Excludes:|Needs:|REQUIRED|[A-Z]:\{")
                for option in re.findall(r"(?m)^  (-\S+)", shown):
                    self.assertIn(option.replace("-", "\\-"), text)
                footer = shown.rfind("\n\n")  # written by hand, with commands to copy
                self.assertLessEqual(max(map(len, shown[:footer].splitlines())), 100)
        self.assertIn("--out FOLDER is missing", self.irsig("manual", "man", code=2).stderr)


    def test_names_without_end(self):
        for name in ("a" * 100000, ":" * 5000, "1:" * 30000, ":1:1: x", "a\n:1:1: b"):
            found = self.irsig("query", name, code=2).stderr
            self.assertTrue(found.startswith("irsig: "), found[:80])

    def test_the_nearest_viewpoint_may_be_far(self):
        found = self.irsig("query", "few.sigdb", "--aspect", "90,89", "--nearest", 1)
        self.assertRegex(found.stderr, r"note: the viewpoints found are up to \d\d deg away from aspect 90,89")
        self.assertNotIn("deg away", self.irsig("query", "few.sigdb", "--aspect", "0,5", "--nearest", 1).stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
