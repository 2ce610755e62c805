"""Derive the gas table of the atmosphere (gas_table.txt) from published spectral files.

usage: make_table.py SP_LW_300 SP_SW_220 MODTRAN_FL7_GZ LOWTRAN_2KM_CSV LOWTRAN_10KM_CSV AFGL_TROPICAL_CSV AFGL_MLS_CSV > gas_table.txt

SP_LW_300, SP_SW_220   SOCRATES spectral files (es96_ref): correlated-k terms per gas and band
MODTRAN_FL7_GZ         MODTRAN .fl7 of a horizontal 5 km path at sea level, tropical, with one column per gas
LOWTRAN_*_CSV          LOWTRAN7 transmittances per absorber, horizontal 2 and 10 km at sea level, mid-latitude summer
AFGL_*_CSV             the two profiles those paths used

What is done to them, and why, is told in docs/explanation/methods/atmosphere.md, "Gas table"; the format in README.md here.
"""

import csv
import gzip
import re
import sys

import numpy as np

import co_lines

R_GAS = 8.314462618
M_AIR = 28.9647e-3
# name -> molar mass [kg/mol], index in the long-wave file, in the short-wave file, Doppler pressure [Pa], fl7 column
GASES = {"H2O": (18.0153e-3, 1, 2, 1500.0, "H2O"), "CO2": (44.0095e-3, 2, 4, 380.0, "CO2"),
         "O3": (47.998e-3, 3, 1, 1380.0, "O3"), "N2O": (44.0128e-3, 4, 5, 15000.0, "N2O"),
         "CH4": (16.0425e-3, 5, 6, 0.0, "CH4"), "CFC11": (137.37e-3, 6, None, 0.0, None),
         "CFC12": (120.91e-3, 7, None, 0.0, None)}
FL7_COLUMNS = ("nu total H2O UMIX O3 TRACE N2 CONT MOLEC AER HNO3 AERAB LOG CO2 CO CH4 N2O O2").split()
FIRST_CM1, LAST_CM1 = 650, 3400
SHORT_WAVE_CM1 = 2990  # where the long-wave file ends: its last band is empty
BANDS = list(range(FIRST_CM1, LAST_CM1, 10))  # lower edges


def blocks(path):
    out, current = {}, None
    for line in open(path):
        if match := re.match(r"\*BLOCK: TYPE = *(\d+): SUBTYPE = *(\d+)", line):
            current = out.setdefault((int(match[1]), int(match[2])), [])
        elif line.startswith("*END"):
            current = None
        elif current is not None:
            current.append(line)
    return out


def read_spectral_file(path):
    """{(band, gas index): (p0, T0, (a, b, c) or None, k, w)}, {(band, kind): (p0, T0, k, (a, b, c))}, band limits."""
    block = blocks(path)
    limits = [tuple(map(float, f[1:])) for f in map(str.split, block[(1, 0)]) if len(f) == 3 and f[0].isdigit()]
    lines = block[(5, 0)]
    start = next(i for i, x in enumerate(lines) if "ESFT EXPONENTS" in x) + 1
    words = iter(" ".join(lines[start:]).split())
    terms = {}
    for word in words:
        band, gas, count, scale_type, scale_function = int(word), *(int(next(words)) for _ in range(4))
        p0, t0 = float(next(words)), float(next(words))
        rows = []
        for _ in range(count):
            rows.append([float(next(words)) for _ in range(2 if scale_type == 0 else 5)])
        rows = np.array(rows)
        if scale_type:
            assert scale_function == 2 and np.all(rows[:, 2:] == rows[0, 2:]), "scaling differs between terms"
        terms[band, gas] = (p0, t0, tuple(rows[0, 2:]) if scale_type else None, rows[:, 0], rows[:, 1])
    lines = block[(9, 0)]
    start = next(i for i, x in enumerate(lines) if x.split() and x.split()[0].isdigit())
    words = iter(" ".join(lines[start:]).split())
    continuum = {}
    for word in words:
        band, kind, scale_function = int(word), int(next(words)), int(next(words))
        assert scale_function == 2
        p0, t0, k, a, b, c = (float(next(words)) for _ in range(6))
        continuum[band, kind] = (p0, t0, k, (a, b, c))
    return terms, continuum, limits


def read_profile_surface(path):
    row = {k: float(v) for k, v in next(csv.DictReader(open(path))).items()}
    air = {"p": row["p_hPa"] * 100, "T": row["T_K"]}
    air.update({g: row[g + "_ppmv"] * 1e-6 for g in ("H2O", "CO2", "O3", "N2O", "CO", "CH4")})
    air["n"] = air["p"] / (R_GAS * air["T"])
    return air


def read_csv(path):
    with open(path) as file:
        rows = list(csv.reader(file))
    return dict(zip(rows[0], np.array(rows[1:], float).T))


def read_fl7(path):
    rows = []
    for line in gzip.open(path, "rt"):
        fields = line.split()
        try:
            rows.append([float(x) for x in fields[:len(FL7_COLUMNS)]])
        except ValueError:
            continue
        if len(rows[-1]) < len(FL7_COLUMNS) or len(fields) < 30 or rows[-1][0] < 650:
            rows.pop()
    table = np.array(rows).T
    return dict(zip(FL7_COLUMNS, table))


WEAK_LINE_POWER = 2.0  # ozone at sea level (fitted at 60 hPa) then needs no correction: -0.02 in ln u, 0.11 rms


class Entry:
    """One gas in one band.

    The files scale an amount by (p/p0)^a for all terms alike, as lines of full centres need. Weak absorption does not
    depend on pressure at all: what the strongest terms hold of the band's mean absorption must stay. So term i sees
    alpha_i times the scaled amount and (1 - alpha_i) times the plain one, alpha_i = (1 - C_i)^2 with C_i the share of
    the mean absorption in weaker terms and half of its own.
    """

    def __init__(self, gas, doppler, p0, t0, scaling, k, w):
        self.gas, self.doppler, self.p0, self.t0, self.k, self.w = gas, doppler, p0, t0, np.array(k), np.array(w)
        self.a, self.b, self.c = scaling or (0.0, 0.0, 0.0)
        self.set_k(self.k)

    def set_k(self, k):
        self.k = k
        share = self.w * self.k / max(np.sum(self.w * self.k), 1e-300)
        self.alpha = np.clip(1 - (np.cumsum(share) - 0.5 * share), 0, 1) ** WEAK_LINE_POWER

    def depths(self, air, length_m, molar_mass):
        """Optical depths of the terms."""
        x = air["T"] / self.t0 - 1
        plain = air["n"] * air[self.gas] * molar_mass * length_m * max(0.0, 1 + self.b * x + self.c * x * x)
        scale = ((air["p"] + self.doppler) / (self.p0 + self.doppler)) ** self.a
        return self.k * plain * (self.alpha * scale + 1 - self.alpha)

    def transmittance(self, depths):
        return float(np.sum(self.w * np.exp(-depths)))

    def slope(self, depths):  # d transmittance / d ln(depth)
        return float(-np.sum(self.w * depths * np.exp(-depths)))


def triangle_weights(nu, boxes=1):
    """Over bands: means over a triangle whose full width at half height is 10 cm-1 (MODTRAN) or twice that (LOWTRAN)."""
    half = 10 * boxes
    weights = np.zeros((len(nu), len(BANDS)))
    s = np.linspace(-half + 0.05, half - 0.05, 200 * boxes)
    triangle = (1 - np.abs(s) / half) / np.sum(1 - np.abs(s) / half)
    for row, x in zip(weights, nu):
        j = np.floor((x + s - FIRST_CM1) / 10).astype(int)
        inside = (j >= 0) & (j < len(BANDS))
        np.add.at(row, j[inside], triangle[inside])
    return weights


def fit_log_factors(entries, air, length_m, molar_mass, nu, measured, damping, smoothing):
    """ln of the factor on the amount per band with which the table reproduces `measured`; 0 where it says nothing."""
    base = [e.depths(air, length_m, molar_mass) if e else np.zeros(1) for e in entries]
    keep = (nu > BANDS[0] + 20) & (nu < SHORT_WAVE_CM1)
    weights, measured = triangle_weights(nu[keep]), measured[keep]
    told = np.array([bool(e) and e.transmittance(u) < 0.998 for e, u in zip(entries, base)])
    n = len(BANDS)
    differences = np.zeros((n - 1, n))
    for i in range(n - 1):
        if told[i] and told[i + 1]:
            differences[i, i:i + 2] = 1, -1
    penalty = damping**2 * np.eye(n) + smoothing**2 * differences.T @ differences
    f = np.zeros(n)
    for _ in range(20):
        u = [depths * np.exp(x) for depths, x in zip(base, f)]
        t = np.array([e.transmittance(v) if e else 1.0 for e, v in zip(entries, u)])
        jacobian = weights * np.array([e.slope(v) if e else 0.0 for e, v in zip(entries, u)])
        step = np.linalg.solve(jacobian.T @ jacobian + penalty,
                               jacobian.T @ (measured - weights @ t) - penalty @ f)
        f += np.clip(step, -0.5, 0.5)
    return np.where(told, f, 0.0)


def fit_structure(entries, molar_mass, cases, first_cm1):
    """Split the short-wave file's bands of 100 cm-1: per band of 10 cm-1 a factor on k and a power that narrows the
    spread of its terms about their weighted mean logarithm, from transmittances of several paths (air, length, rows of
    weights over BANDS, values, trust). Ten narrow bands of one wide one spread less than it: the power tends to 0.7."""
    index = [i for i, low in enumerate(BANDS) if low >= first_cm1 and entries[i]]
    for i in index:
        entries[i].log_k = np.log(np.maximum(entries[i].k, 1e-8))
        entries[i].mean_log = np.sum(entries[i].w * entries[i].log_k)
    prior = np.tile([0.0, 0.7], len(index))
    x = prior.copy()
    outside = [[1.0 if not e else e.transmittance(e.depths(air, length, molar_mass)) for e in entries]
               for air, length, *_ in cases]

    def model(x):
        out = []
        for n, i in enumerate(index):
            e = entries[i]
            e.set_k(np.exp(e.mean_log + np.clip(x[2 * n + 1], 0.3, 1.3) * (e.log_k - e.mean_log) + x[2 * n]))
        for (air, length, weights, values, trust), t in zip(cases, outside):
            for i in index:
                t[i] = entries[i].transmittance(entries[i].depths(air, length, molar_mass))
            out.append(trust * (weights @ np.array(t) - values))
        return np.concatenate(out)

    penalty = np.diag(np.tile([0.006**2, 0.1**2], len(index)))
    for n in range(len(index) - 1):  # samples of triangles twice as wide as the bands cannot tell neighbours apart
        for a, b, sign in ((n, n, 1), (n + 1, n + 1, 1), (n, n + 1, -1), (n + 1, n, -1)):
            penalty[2 * a, 2 * b] += sign * 0.02**2
            penalty[2 * a + 1, 2 * b + 1] += sign * 0.05**2
    for _ in range(15):
        r = model(x)
        jacobian = np.empty((len(r), len(x)))
        for j in range(len(x)):
            y = x.copy()
            y[j] += 1e-3
            jacobian[:, j] = (model(y) - r) / 1e-3
        step = np.linalg.solve(jacobian.T @ jacobian + penalty, -jacobian.T @ r - penalty @ (x - prior))
        x += np.clip(step, -0.4, 0.4)
        x[1::2] = np.clip(x[1::2], 0.3, 1.3)
    model(x)


def continuum_depth(continuum, band, air, q, rho, x_w, n, length):
    """Optical depths of the self and the foreign part."""
    for kind, density in ((1, n * x_w * q * rho), (2, n * q * (1 - q) * rho)):
        p0, t0, k, (a, b, c) = continuum[band, kind]
        x = air["T"] / t0 - 1
        yield k * density * length * (air["p"] / p0) ** a * (1 + b * x + c * x * x)


def per_band(nu, values):
    return np.interp(np.array(BANDS) + 5.0, nu, values)


def main(sp_lw, sp_sw, fl7_path, lowtran_2km_path, lowtran_10km_path, tropical_path, summer_path):
    lw, lw_continuum, lw_limits = read_spectral_file(sp_lw)
    sw, sw_continuum, sw_limits = read_spectral_file(sp_sw)
    assert len(lw_limits) == 300
    lowtran_2km, lowtran_10km = read_csv(lowtran_2km_path), read_csv(lowtran_10km_path)
    sw_band = {round(1e-2 / high): i + 1 for i, (low, high) in enumerate(sw_limits)}
    fl7, tropical, summer = read_fl7(fl7_path), read_profile_surface(tropical_path), read_profile_surface(summer_path)
    length = 5000.0

    def source(low):  # (file, band)
        return ("lw", low // 10 + 1) if low < SHORT_WAVE_CM1 else ("sw", sw_band[low // 100 * 100])

    def rows_of(nu, values, boxes):
        keep = (nu > SHORT_WAVE_CM1 + 2) & (nu < LAST_CM1 - 20)
        return triangle_weights(nu[keep], boxes), values[keep]

    table = {}
    for gas, (mass, lw_index, sw_index, doppler, column) in GASES.items():
        entries = []
        for low in BANDS:
            file, band = source(low)
            found = lw.get((band, lw_index)) if file == "lw" else sw.get((band, sw_index))
            entries.append(Entry(gas, doppler if file == "lw" else 0.0, *found) if found else None)
        if column:
            smoothing = 0.15 if gas == "H2O" else 0.0
            factors = fit_log_factors(entries, tropical, length, mass, fl7["nu"], fl7[column], 0.02, smoothing)
            for low, e, f in zip(BANDS, entries, factors):
                if not e:
                    continue
                if gas == "CO2" and low >= 2400 and low < 2600:
                    continue  # beyond the band head: the continuum below
                e.set_k(e.k * np.exp(f))
            lowtran_column = {"H2O": "t_h2o_lines", "CH4": "t_ch4", "N2O": "t_n2o"}.get(gas)
            cases = [(tropical, length, *rows_of(fl7["nu"], fl7[column], 1), 1.0)]
            if lowtran_column:
                for run, metres in ((lowtran_2km, 2e3), (lowtran_10km, 1e4)):
                    cases.append((summer, metres, *rows_of(run["wavenumber_cm1"], run[lowtran_column], 2), 0.5))
            fit_structure(entries, mass, cases, SHORT_WAVE_CM1)
        table[gas] = entries

    print(HEADER)
    print(f"bands {len(BANDS)} {FIRST_CM1} 10")
    masses = {g: v[0] for g, v in GASES.items()} | {"CO": co_lines.MOLAR_MASS}
    carbon_monoxide = []
    for low in BANDS:
        terms = co_lines.band_terms(low) if 1900 <= low < 2300 else None
        carbon_monoxide.append(
            Entry("CO", 0.0, co_lines.P0_PA, co_lines.T0_K, terms[2], terms[0], terms[1]) if terms else None)
    table["CO"] = carbon_monoxide
    for gas, mass in masses.items():
        print(f"gas {gas} {mass:.7g}")
        for low, e in zip(BANDS, table[gas]):
            if not e:
                continue
            keep = e.w > 2e-6
            k, w, alpha = e.k[keep], e.w[keep] / e.w[keep].sum(), e.alpha[keep]
            print(f"{low} {e.p0:.6g} {e.t0:.6g} {e.doppler:.6g} {e.a:.6g} {e.b:.6g} {e.c:.6g} {len(k)}",
                  *(f"{x * z:.6g} {x * (1 - z):.6g} {y:.6g}" for x, y, z in zip(k, w, alpha)))

    # Water continuum. The foreign part is rescaled where MODTRAN's differs (1900-2250 cm-1), both where the file has one
    # value per 100 cm-1.
    wanted = -np.log(np.maximum(per_band(fl7["nu"], fl7["CONT"]), 1e-9))
    x_w, n = tropical["H2O"], tropical["n"]
    rho = n * (M_AIR * (1 - x_w) + GASES["H2O"][0] * x_w)
    q = n * x_w * GASES["H2O"][0] / rho
    for kind, name in ((1, "self"), (2, "foreign")):
        print(f"continuum {name}")
        for low, tau in zip(BANDS, wanted):
            file, band = source(low)
            found = (lw_continuum if file == "lw" else sw_continuum).get((band, kind))
            if not found:
                continue
            p0, t0, k, (a, b, c) = found
            factor = 1.0
            if low >= SHORT_WAVE_CM1:  # the short-wave file has one value per 100 cm-1
                factor = tau / sum(continuum_depth(sw_continuum, band, tropical, q, rho, x_w, n, length))
            if kind == 2 and 1900 <= low < 2250 and 0.002 < tau < 7:
                parts = {}
                for other, density in ((1, n * x_w * q * rho), (2, n * q * (1 - q) * rho)):
                    op0, ot0, ok, (oa, ob, oc) = lw_continuum[band, other]
                    x = tropical["T"] / ot0 - 1
                    parts[other] = (ok * density * length * (tropical["p"] / op0) ** oa * (1 + ob * x + oc * x * x))
                factor = max(0.0, (tau - parts[1]) / parts[2])
            print(f"{low} {p0:.6g} {t0:.6g} {a:.6g} {b:.6g} {c:.6g} {k * factor:.6g}")

    # Collision-induced bands and the far wing of carbon dioxide: optical depth = k n_absorber n_air length.
    shape = -np.log(per_band(lowtran_10km["wavenumber_cm1"], lowtran_10km["t_n2_cont"])) / 10e3
    n2 = shape / (0.781 * summer["n"] ** 2)
    fl7_n2 = -np.log(per_band(fl7["nu"], fl7["N2"])) / length / (0.781 * tropical["n"] ** 2)
    strong = shape * length > 0.05
    ratio = float(np.median(fl7_n2[strong] / n2[strong]))
    print("collision N2", f"# LOWTRAN7's shape times {ratio:.4f}: MODTRAN's strength")
    for low, k in zip(BANDS, n2 * ratio):
        if k * length * n * n * 0.781 > 1e-5:
            print(f"{low} {k:.6g}")
    print("collision O2")
    for low, k in zip(BANDS, -np.log(per_band(fl7["nu"], fl7["O2"])) / length / (0.2095 * tropical["n"] ** 2)):
        if k > 0 and low < 1800:
            print(f"{low} {k:.6g}")
    print("collision CO2")
    for low, e, t in zip(BANDS, table["CO2"], per_band(fl7["nu"], fl7["CO2"])):
        if 2400 <= low < 2600 and 0 < t < 0.9999:
            u = e.depths(tropical, length, masses["CO2"]) if e else np.zeros(1)
            extra = -np.log(t) + (np.log(e.transmittance(u)) if e else 0.0)
            if extra > 0:
                print(f"{low} {extra / length / (tropical['CO2'] * n * n):.6g}")


HEADER = """# irsig gas table 1: correlated-k terms per gas and 10 cm-1 band; made by make_table.py, format in README.md.
# Derived from the SOCRATES spectral files sp_lw_300_orig and sp_sw_220_r (es96_ref), (C) Crown copyright Met Office,
# BSD-3 licence (LICENCE_SOCRATES, which goes with this file), from MODTRAN and LOWTRAN7 outputs and from co_lines.py."""

if __name__ == "__main__":
    if len(sys.argv) != 8:
        sys.exit(__doc__)
    main(*sys.argv[1:])
