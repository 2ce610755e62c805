"""One server of a small database and of a copy with other intensities, for the tests of irsig serve.

Their arguments: <irsig executable> <source folder>
"""
import os
import pathlib
import shutil
import sqlite3
import sys
import tempfile
import unittest

from serve_fixture import Server, small_sweep

IRSIG, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])


class ServeCase(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.path = pathlib.Path(cls.folder.name)
        cls.db = cls.path / "it's small.sigdb"
        cls.other = cls.path / "-other.sigdb"
        small_sweep(IRSIG, SOURCE, cls.path / "small.toml", cls.db)
        shutil.copy(cls.db, cls.other)
        with sqlite3.connect(cls.other) as db:
            db.execute("UPDATE signature SET intensity_w_sr = intensity_w_sr + 5 * numerical_error_w_sr")
        db.close()
        os.chdir(cls.path)
        cls.server = Server(IRSIG, cls.db, f"./{cls.other.name}")
        cls.addClassCleanup(cls.server.end)
        cls.contents = cls.server.json("/api/contents")

    def selection(self, **other):
        sweep = self.contents["database"][0]["sweep"][0]
        return {"sweep": sweep["name"], "season": sweep["condition"][0]["season"], "time": sweep["condition"][0]["time_utc"],
                "band": sweep["band"][0]["name"], "at_range_m": sweep["range_m"][0], **other}
