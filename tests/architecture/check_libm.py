"""Fail when the fingerprint of the arithmetic covers other functions of the C library than results depend on.

usage: check_libm.py <library> ...

Reads which functions of <math.h> and <complex.h> each library calls. core/base/arithmetic_fingerprint.cpp hashes what
those return that are not exactly rounded; a function that it leaves out could differ between two machines of one
determinism class, one that nothing calls would tell machines apart that compute the same.
"""

import re
import subprocess
import sys

EXACT = {"ceil", "copysign", "fabs", "fdim", "floor", "fma", "fmax", "fmin", "fmod", "frexp", "ilogb", "ldexp", "llrint", "llround", "logb",
         "lrint", "lround", "modf", "nearbyint", "nextafter", "remainder", "remquo", "rint", "round", "scalbln", "scalbn", "sqrt", "trunc",
         "cabs"}  # cabs is hypot
ROUNDED = {"acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "cbrt", "cos", "cosh", "erf", "erfc", "exp", "exp2", "expm1", "hypot",
           "j0", "j1", "lgamma", "log", "log10", "log1p", "log2", "pow", "sin", "sincos", "sinh", "tan", "tanh", "tgamma", "y0", "y1",
           "cacos", "casin", "catan", "ccos", "ccosh", "cexp", "clog", "cpow", "csin", "csinh", "csqrt", "ctan", "ctanh"}
FINGERPRINT = re.compile(r"arithmetic_fingerprint\.cpp\.o$")


def functions(name):
    """The rounded functions that a symbol stands for, each with its type (f, l or none)."""
    name = name.split("@")[0]
    for base, suffix in ((name, ""), (name[:-1], name[-1:])):
        if base in ROUNDED and suffix in ("", "f", "l"):
            return {part + suffix for part in (("sin", "cos") if base == "sincos" else (base,))}
    return set()


def check(symbols):
    """`symbols`: (object, undefined symbol) of all libraries."""
    covered, called = set(), {}
    for member, symbol in symbols:
        for function in functions(symbol):
            if FINGERPRINT.search(member):
                covered.add(function)
            else:
                called.setdefault(function, member)
    return ([f"{called[f]} calls {f}: add it to core/base/arithmetic_fingerprint.cpp" for f in sorted(called.keys() - covered)] +
            [f"core/base/arithmetic_fingerprint.cpp covers {f}, which nothing calls: remove it" for f in sorted(covered - called.keys())])


def undefined(library):
    listing = subprocess.run(["nm", "-A", "-u", library], capture_output=True, text=True, check=True).stdout
    for line in listing.splitlines():
        if found := re.match(r".*?:(?:([^:]+):)?\s+U (\S+)$", line):
            yield found[1] or library, found[2]


if __name__ == "__main__":
    findings = check([pair for library in sys.argv[1:] for pair in undefined(library)])
    print("\n".join(findings))
    sys.exit(bool(findings))
