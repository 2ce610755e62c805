"""Images as TIFF and as ENVI cubes, read by the specifications of both formats, against the stored pixels.

usage: image_formats_test.py <irsig> <repository>
"""
import csv, io, pathlib, re, signal, struct, subprocess, sys, tempfile, time, unittest

import numpy

IRSIG, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
sys.path.insert(0, str(ROOT / "python"))
import irsig as reader  # noqa: E402

# The longest side that a sweep may ask for: three images at a time, so that an export cuts its rows often.
SIZE = (4096, 4)


def irsig(*arguments, expect=0):
    done = subprocess.run([IRSIG, *map(str, arguments)], capture_output=True, text=True, timeout=300)
    assert done.returncode == expect, f"{arguments}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done


def table(folder):
    return list(csv.DictReader(io.StringIO((folder / "labels.csv").read_text())))


def files(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def tiff(path):
    """Pixels and fields of a TIFF of one strip, by TIFF 6.0."""
    data = path.read_bytes()
    mark, at = struct.unpack_from("<4sI", data)
    assert mark == b"II*\0" and at % 2 == 0
    sizes = {2: 1, 3: 2, 4: 4, 5: 8}
    fields, tags = {}, []
    for i in range(struct.unpack_from("<H", data, at)[0]):
        tag, kind, count = struct.unpack_from("<HHI", data, at + 2 + 12 * i)
        tags.append(tag)
        place = at + 10 + 12 * i
        if count * sizes[kind] > 4:
            place = struct.unpack_from("<I", data, place)[0]
        value = data[place:place + count * sizes[kind]]
        fields[tag] = value.rstrip(b"\0").decode() if kind == 2 else struct.unpack(f"<{count}{' HI'[kind - 2]}", value)[0] if kind < 5 else struct.unpack("<II", value)
    assert tags == sorted(tags)
    assert (fields[259], fields[262], fields[277]) == (1, 1, 1)
    kind = {(8, 1): "<u1", (16, 1): "<u2", (32, 3): "<f4"}[fields[258], fields[339]]
    strip = data[fields[273]:fields[273] + fields[279]]
    return numpy.frombuffer(strip, kind).reshape(fields[257], fields[256]), fields


def cube(header):
    """Bands of an ENVI cube and the fields of its header."""
    text = header.read_text()
    assert text.startswith("ENVI\n")
    fields = {k: v.strip("{}") for k, v in re.findall(r"^([a-z ]+) = (\{[^}]*\}|.*)$", text, re.M)}
    assert (fields["data type"], fields["byte order"], fields["interleave"], fields["header offset"]) == ("4", "0", "bsq", "0")
    shape = [int(fields[k]) for k in ("bands", "lines", "samples")]
    return numpy.fromfile(header.with_suffix(".bsq"), "<f4").reshape(shape), fields


class ImageFormats(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        text = (ROOT / "jobs/examples/quickstart.toml").read_text()
        text = text.replace("count = 24", "count = 3").replace("triangles = 20000", "triangles = 2000")
        text = re.sub(r"(?m)^thumbnail_px.*$", "", text)
        (cls.path / "s.toml").write_text(text + f'\n[image]\npixels = {list(SIZE)}\nsamples = 4\nlayers = ["at_sensor"]\n')
        cls.db = cls.path / "s.sigdb"
        irsig("run", cls.path / "s.toml", "--db", cls.db, "--workers", "2")
        cls.rows = reader.open(cls.db).query()

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def export(self, name, *options, **more):
        irsig("export", self.db, "--thumbnails", "--out", self.path / name, *options, **more)
        return self.path / name

    def test_tiff_of_grey_is_on_the_scale_of_its_label(self):
        for bits in (8, 16):
            folder = self.export(f"grey{bits}", "--image-format", "tiff", "--bits", bits)
            labels = table(folder)
            self.assertEqual(len(labels), 18)
            for label, stored in zip(labels, self.rows.images()):
                got, fields = tiff(folder / label["image"])
                black, white = float(label["black_w_m2_sr"]), float(label["white_w_m2_sr"])
                exact = (2**bits - 1) * numpy.clip((stored.astype(float) - black) / (white - black), 0, 1)
                self.assertEqual(got.shape, (SIZE[1], SIZE[0]))
                self.assertLess(abs(got - exact).max(), 0.5 + 1e-6)
                said = re.fullmatch(r"in-band radiance, W/\(m2 sr\): 0 is (\S+), (\d+) is (\S+)", fields[270])
                self.assertEqual(int(said[2]), 2**bits - 1)
                self.assertEqual([numpy.float32(said[1]), numpy.float32(said[3])], [numpy.float32(black), numpy.float32(white)])
            self.assertEqual(max(tiff(folder / label["image"])[0].max() for label in labels), 2**bits - 1)

    def test_tiff_of_32_bits_has_the_stored_radiances(self):
        folder = self.export("float", "--image-format", "tiff", "--bits", "32")
        labels = table(folder)
        self.assertNotIn("white_w_m2_sr", labels[0])
        for label, stored in zip(labels, self.rows.images()):
            got, fields = tiff(folder / label["image"])
            self.assertTrue(numpy.array_equal(got, stored))
            self.assertEqual(fields[270], "in-band radiance, W/(m2 sr)")

    def test_a_cube_has_the_bands_of_a_viewpoint_and_condition(self):
        for options, layer in (((), None), (("--background",), "at_sensor")):
            folder = self.export("cube" + str(layer), "--image-format", "envi", "--masks", *options)
            labels = table(folder)
            stored = self.rows.images(layer) if layer else self.rows.images()
            self.assertEqual(len(list(folder.glob("images/*.hdr"))), 9)
            self.assertEqual(len(list(folder.glob("images/*.bsq"))), 9)
            for i, (label, image) in enumerate(zip(labels, stored)):
                path = folder / label["image"]
                self.assertEqual((path.name, label["image_band"]), (f"{1 + i - i % 2:07}.bsq", str(1 + i % 2)))
                self.assertTrue((folder / label["mask"]).exists())
                bands, fields = cube(path.with_suffix(".hdr"))
                self.assertTrue(numpy.array_equal(bands[i % 2], image))
                self.assertEqual(bands.shape, (2, SIZE[1], SIZE[0]))
                self.assertEqual(fields["band names"], "mwir, lwir")
                self.assertEqual((fields["wavelength"], fields["fwhm"]), ("4, 10", "2, 4"))
                self.assertEqual((fields["wavelength units"], fields["data units"]), ("Micrometers", "W/(m2 sr)"))
                self.assertIn("at the sensor" if layer else "at the target", fields["description"])
                self.assertIn(label["season"], fields["description"])
        one, _ = cube(self.export("one", "--image-format", "envi", "--band", "lwir", "--season", "winter") / "images/0000002.hdr")
        self.assertEqual(one.shape[0], 1)

    def test_an_export_of_cubes_that_was_killed_goes_on(self):
        whole = self.export("whole", "--image-format", "envi")
        question = ("--thumbnails", "--image-format", "envi", "--out", self.path / "k")
        for wait_s in (0.03, 0.06, 0.1):
            process = subprocess.Popen([IRSIG, "export", self.db, *question], stderr=subprocess.DEVNULL)
            time.sleep(wait_s)
            process.send_signal(signal.SIGKILL)
            process.wait()
        if (self.path / "k.partial/progress").exists():
            self.assertIn("is of another export", irsig("export", self.db, "--thumbnails", "--out", self.path / "k", expect=2).stderr)
        if not (self.path / "k").exists():
            irsig("export", self.db, *question)
        self.assertEqual(files(self.path / "k"), files(whole))

    def test_what_does_not_go_together_is_refused(self):
        for options, why in ((("--image-format", "jpg"), "--image-format jpg: expected one of png, tiff, envi"),
                             (("--bits", "12"), "--bits 12: expected one of 8, 16, 32"),
                             (("--bits", "32"), "--bits 32: float32 belongs to --image-format tiff"),
                             (("--image-format", "envi", "--bits", "16"), "--bits: cubes of --image-format envi are float32"),
                             (("--image-format", "envi", "--coco"), "--coco: its images have one band each"),
                             (("--image-format", "envi", "--thumbnail-scale", "own"), "--thumbnail-scale: float32 pictures have no black"),
                             (("--image-format", "tiff", "--bits", "32", "--thumbnail-scale", "0,1"), "--thumbnail-scale: float32"),
                             (("--image-format", "tiff", "--background", "--imager", ROOT / "jobs/examples/imagers/mwir.toml"), "--imager: counts are written as --image-format png alone")):
            said = irsig("export", self.db, "--thumbnails", "--out", self.path / "no", *options, expect=2).stderr
            self.assertIn(why, said)
            self.assertFalse((self.path / "no").exists())
        self.assertIn("--image-format: belongs to the format thumbnails", irsig("export", self.db, "--image-format", "tiff", "--out", self.path / "x.csv", expect=2).stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
