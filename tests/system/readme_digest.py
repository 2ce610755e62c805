"""The digest of a database, computed anew from schema/README.md and schema/sql/digest.sql alone."""
import hashlib, pathlib, re, sqlite3, struct

SCHEMA = pathlib.Path(__file__).resolve().parents[2] / "schema"
# Statements whose first column is the id that the statement after them is asked for, row by row.
OF_EACH_ROW = {"digest_conditions": "digest_part_temperatures", "digest_bands": "digest_band_response",
               "digest_heat_jobs": "digest_computed_temperatures"}
CONDITION = {"digest_heat_jobs": "has_heat_output", "digest_plume": "has_plume", "digest_plume_details": "has_plume_details",
             "digest_clutter": "has_clutter", "digest_clutter_materials": "has_clutter",
             "digest_input_contributions": "has_input_contributions", "digest_part_sets": "has_part_sets"}


def digest(database):
    page = re.search(r"^The bytes: the text `(irsig digest \d+)`(.*?)A statement", (SCHEMA / "README.md").read_text(), re.S | re.M)
    first, *order = re.findall(r"`(digest_\w+)`", page[2])
    split = order.index("digest_signatures")
    statements = dict(re.findall(r"^-- name: (\w+)\n(.*?;)$", (SCHEMA / "sql/digest.sql").read_text(), re.S | re.M))
    missing = {name for name in statements if name.startswith("digest_")} ^ {first, *order}
    assert not missing, f"in the README or in digest.sql alone: {missing}"
    hashed = hashlib.sha256()

    def add(value):
        if value is None:
            hashed.update(b"n")
        elif isinstance(value, int):
            hashed.update(b"i" + struct.pack("<q", value))
        elif isinstance(value, float):
            hashed.update(b"r" + struct.pack("<d", value))
        else:
            content = value.encode() if isinstance(value, str) else value
            hashed.update((b"t" if isinstance(value, str) else b"b") + struct.pack("<Q", len(content)) + content)

    def rows(name, has_id, *of):
        """Adds a statement; returns the ids of its rows."""
        hashed.update(b"s")
        ids = []
        for row in db.execute(statements[name], of):
            hashed.update(b"|")
            ids += row[:has_id]
            for value in row[has_id:]:
                add(value)
        return ids

    def all_of(names, of):
        for name in names:
            if name in OF_EACH_ROW.values():
                continue
            if name in CONDITION and db.execute(statements[CONDITION[name]], (of,)).fetchone()[0] != 1:
                continue
            for row in rows(name, name in OF_EACH_ROW, of):
                rows(OF_EACH_ROW[name], False, row)

    with sqlite3.connect(f"file:{database}?mode=ro", uri=True) as db:
        add(page[1])
        for sweep in rows(first, True):
            all_of(order[:split], sweep)
            for signature in rows("digest_signatures", True, sweep):
                all_of(order[split + 1:], signature)
    db.close()
    return hashed.hexdigest()
