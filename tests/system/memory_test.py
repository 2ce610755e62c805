"""What a sweep takes of memory is said before it starts, and is so.

usage: memory_test.py <irsig> <irsig-coordinator> <irsig-worker> <repository>
"""
import os, pathlib, re, resource, subprocess, sys, tempfile, unittest

IRSIG, COORDINATOR, WORKER, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:5])
FRIGATE = (ROOT / "jobs/examples/frigate.toml").read_text()


def hours(count, step_um, viewpoints=2, triangles=5000):
    """The frigate in one season of real air, at so many times of a day with sun."""
    times = [f'"{6 + i * 12 // count:02}:{i * 12 * 60 // count % 60:02}+09:00"' for i in range(count)]
    text = re.sub(r'time = \["10:30\+09:00"\]', f"time = [{', '.join(times)}]", FRIGATE)
    head, winter, *_ = text.split("[[season]]")
    text = head + "[[season]]" + winter + "[[band]]" + text.split("[[band]]", 1)[1]
    text = re.sub(r"\[precompute\].*", "", text, flags=re.S)
    for old, new in (("step_um = 0.05", f"step_um = {step_um}"), ("count = 191", f"count = {viewpoints}"),
                     ("triangles = 200000", f"triangles = {triangles}"),
                     ("relative_error = 0.002", "relative_error = 0.1")):
        assert old in text, old
        text = text.replace(old, new)
    return text


class Memory(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def irsig(self, *arguments, **more):
        return subprocess.run([IRSIG, *arguments], cwd=self.path, capture_output=True, text=True, timeout=600, **more)

    def stated_mb(self, text):
        said = re.search(r"about ([\d.]+) ([MG])B with 1 worker", text)
        self.assertTrue(said, text)
        return float(said[1]) * (1000 if said[2] == "G" else 1)

    def resident_mb(self):
        """Of a worker that computes sweep.toml: the most that it ever had."""
        address = f"unix:{self.path}/socket"
        coordinator = subprocess.Popen([COORDINATOR, "--db", "x.sigdb", "--listen", address], cwd=self.path, text=True,
                                       stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        coordinator.stdout.readline()
        self.assertEqual(self.irsig("submit", "sweep.toml", "--coordinator", address).returncode, 0)
        worker = subprocess.Popen([WORKER, "--coordinator", address, "--exit-when-finished"], cwd=self.path,
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, used = os.wait4(worker.pid, 0)
        coordinator.terminate()
        coordinator.communicate()
        (self.path / "x.sigdb").unlink()
        self.assertEqual(status, 0)
        return used.ru_maxrss * 1024 / 1e6

    def test_what_is_stated_is_taken(self):
        for count, step_um in ((2, 0.1), (16, 0.1), (8, 0.02)):
            with self.subTest(conditions=count, step_um=step_um):
                (self.path / "sweep.toml").write_text(hours(count, step_um))
                plan = self.irsig("plan", "sweep.toml", "--workers", "1")
                self.assertEqual(plan.returncode, 0, plan.stderr)
                stated, taken = self.stated_mb(plan.stdout), self.resident_mb()
                print(f"{count} conditions, {step_um} um: stated {stated:.0f} MB, taken {taken:.0f} MB", file=sys.stderr)
                self.assertGreater(taken, 0.75 * stated)
                self.assertLess(taken, 1.1 * stated)

    def test_what_does_not_fit_is_refused(self):
        limit = 1_500_000_000
        (self.path / "sweep.toml").write_text(hours(700, 0.05))
        for command in (["run", "sweep.toml", "--db", "out.sigdb"], ["plan", "sweep.toml"]):
            done = self.irsig(*command, "--workers", "2",
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
            self.assertEqual(done.returncode, 1, done.stderr)
            fits = re.search(r"about ([\d.]+) GB with 1 worker, ([\d.]+) GB with 2 \(([\d.]+) MB for each of 700 conditions\), "
                             r"and 1.5 GB of memory are free: (\d+) conditions would fit with 2 workers, (\d+) with "
                             r"--workers 1", done.stderr)
            self.assertTrue(fits, done.stderr)
            one, two, of_condition, with_two, with_one = (float(fits[i]) for i in range(1, 6))
            shared, room = 1000 * (2 * one - two), limit / 1e6
            self.assertGreater(shared, 30)  # the program and the light of the weathers
            rounded = 0.1 * 1000 / of_condition + 3  # GB to one digit
            self.assertAlmostEqual(with_two, 700 - (1000 * two - room) / 2 / of_condition, delta=rounded)
            self.assertAlmostEqual(with_one, 700 - (1000 * one - room) / of_condition, delta=rounded)
            self.assertGreater(with_one, with_two)
            self.assertFalse((self.path / "out.sigdb").exists())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[5:])
