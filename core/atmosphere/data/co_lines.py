"""Absorption of carbon monoxide around 4.67 um from first principles: the fundamental of a diatomic molecule.

Line positions from the rotational and vibrational constants of the three abundant isotopologues, strengths from the
band strength and the rigid-rotor Hoenl-London factors with the first Herman-Wallis term, air-broadened Lorentz lines.
Used by make_table.py, because the spectral files have no carbon monoxide.

Constants: ground and first excited level of 12C16O, 13C16O, 12C18O (Guelachvili et al., J. Mol. Spectrosc. 98, 64,
1983, rounded); band strength 9.9e-18 cm/molecule of natural CO at 296 K; half widths between 0.080 and 0.045 cm-1/atm
with |m|, as measured by Hunt, Toth and Plyler, J. Chem. Phys. 49, 3909 (1968); temperature exponent 0.69.
"""

import numpy as np

C2_CM_K = 1.438777
AVOGADRO = 6.02214076e23
MOLAR_MASS = 28.0101e-3
#             abundance, nu0, B0, D0, B1, D1
ISOTOPES = [(0.98654, 2143.2711, 1.9225290, 6.1206e-6, 1.9050256, 6.1199e-6),
            (0.01108, 2096.0672, 1.8379720, 5.5938e-6, 1.8216020, 5.5933e-6),
            (0.00198, 2092.1222, 1.8309810, 5.5500e-6, 1.8147050, 5.5500e-6)]
BAND_STRENGTH = 9.9e-18


def lines(temperature_k):
    """nu [cm-1], strength [m2/kg cm-1], Lorentz half width at 1 atm [cm-1]."""
    out = []
    for share, nu0, b0, d0, b1, d1 in ISOTOPES:
        j = np.arange(0, 45)
        e0 = b0 * j * (j + 1) - d0 * (j * (j + 1)) ** 2
        e1 = lambda k: nu0 + b1 * k * (k + 1) - d1 * (k * (k + 1)) ** 2
        q = np.sum((2 * j + 1) * np.exp(-C2_CM_K * e0 / temperature_k))
        q_vib = 1 / (1 - np.exp(-C2_CM_K * nu0 / temperature_k))
        for upper, m in ((j + 1, j + 1), (j - 1, -j)):
            ok = m != 0
            nu = e1(upper[ok]) - e0[ok]
            a = np.abs(m[ok])
            herman_wallis = (1 + 1.2e-4 * m[ok]) ** 2
            s = (BAND_STRENGTH * share * a / q * nu / nu0 * np.exp(-C2_CM_K * e0[ok] / temperature_k) * herman_wallis
                 * (1 - np.exp(-C2_CM_K * nu / temperature_k)) / q_vib)
            width = (0.045 + 0.035 * np.exp(-(a - 1) / 9.0)) * (296 / temperature_k) ** 0.69
            out.append(np.stack([nu, s * 1e-4 * AVOGADRO / MOLAR_MASS, width]))
    return np.concatenate(out, axis=1)


def absorption_m2_kg(nu, temperature_k, pressure_pa):
    k = np.zeros_like(nu)
    for centre, s, width in lines(temperature_k).T:
        g = width * pressure_pa / 101325
        near = np.abs(nu - centre) < 25
        k[near] += s * g / np.pi / ((nu[near] - centre) ** 2 + g * g)
    return k


P0_PA, T0_K = 50000.0, 250.0


def band_terms(low_cm1, count=8):
    """Correlated-k terms of one 10 cm-1 band: k [m2/kg], w, and the scaling a, b, c about P0_PA, T0_K."""
    nu = low_cm1 + (np.arange(5000) + 0.5) * 0.002
    k0 = np.sort(absorption_m2_kg(nu, T0_K, P0_PA))
    # Groups of equal share near the median and ever finer towards the strongest.
    edges = np.unique((5000 * np.array([0, .25, .5, .7, .83, .91, .96, .985, 1.0])[:count + 1]).astype(int))
    w = np.diff(edges) / 5000
    k = np.array([k0[a:b].mean() for a, b in zip(edges[:-1], edges[1:])])
    if k.max() * 0.01 < 1e-3:  # 10 g/m2 is ten times the air's whole column
        return None
    amount = 2e-3  # kg/m2: 10 km of surface air hold 1.8e-3
    target = lambda s: np.sum(w * np.exp(-k * amount * s))

    def scale(p, t):
        exact = np.mean(np.exp(-absorption_m2_kg(nu, t, p) * amount))
        low, high = 1e-4, 1e4
        for _ in range(60):
            mid = np.sqrt(low * high)
            low, high = (mid, high) if target(mid) > exact else (low, mid)
        return np.sqrt(low * high)

    pressures = np.array([1e4, 2.5e4, 5e4, 7e4, 1.013e5])
    s0 = scale(P0_PA, T0_K)
    a = np.polyfit(np.log(pressures / P0_PA), [np.log(scale(p, T0_K) / s0) for p in pressures], 1)[0]
    temperatures = np.array([210.0, 230.0, 270.0, 290.0, 300.0])
    x = temperatures / T0_K - 1
    y = np.array([scale(P0_PA, t) / s0 - 1 for t in temperatures])
    b, c = np.linalg.lstsq(np.stack([x, x * x], axis=1), y, rcond=None)[0]
    return k, w, (a, b, c)
