#!/usr/bin/env python3
"""Prints tests/unit/surrogate/rank_tests_expected.hpp: what SciPy (python3-scipy 1.10) says of small data sets with
ties, small groups and missing values. Run: /usr/bin/python3 rank_tests_reference.py > rank_tests_expected.hpp
"""
import numpy as np
from scipy import stats

nan = float("nan")
plain_x = [1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30]
plain_y = [0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06001, 3.14, 1.29001]
ties_x = [1, 2, 2, 3, 5, 5, 5, 7, 9, 9, 11, 12]
ties_y = [2, 2, 4, 5, 5, 8, 9, 9, 13, 14, 14, 15]
small = [0.4, 2.2, 1.1]
long_x = [round(np.sin(1.7 * k) + 0.03 * k, 6) for k in range(60)]
long_y = [round(np.cos(2.3 * k) + 0.01 * k, 6) for k in range(60)]
missing = [2.5, nan, 0.7, 4.1, nan, 3.3, 2.0, 5.2, 1.4]


def clean(values):
    return [v for v in values if v == v]


def pairs(x, y):
    both = [(a, b) for a, b in zip(x, y) if a == a and b == b]
    return [a for a, _ in both], [b for _, b in both]


def mann_whitney(x, y):
    x, y = clean(x), clean(y)
    exact = min(len(x), len(y)) <= 8 and len(set(x + y)) == len(x + y)
    return stats.mannwhitneyu(x, y, method="exact" if exact else "asymptotic")


def wilcoxon(x, y):
    x, y = pairs(x, y)
    d = [a - b for a, b in zip(x, y)]
    sizes = [abs(v) for v in d]
    exact = len(d) <= 50 and 0 not in d and len(set(sizes)) == len(sizes)
    return stats.wilcoxon(d, mode="exact" if exact else "approx")


cases = {
    "mann_whitney_plain": mann_whitney(plain_x, plain_y),
    "mann_whitney_ties": mann_whitney(ties_x, ties_y),
    "mann_whitney_small": mann_whitney(small, plain_y),
    "mann_whitney_long": mann_whitney(long_x, long_y),
    "mann_whitney_missing": mann_whitney(missing, plain_y),
    "wilcoxon_plain": wilcoxon(plain_x, plain_y),
    "wilcoxon_ties": wilcoxon(ties_x, ties_y),
    "wilcoxon_long": wilcoxon(long_x, long_y),
    "wilcoxon_missing": wilcoxon(missing, plain_y),
    "kruskal_plain": stats.kruskal(plain_x, plain_y, small),
    "kruskal_ties": stats.kruskal(ties_x, ties_y, small),
    "kruskal_missing": stats.kruskal(clean(missing), ties_x, plain_y),
    "spearman_plain": stats.spearmanr(plain_x, plain_y),
    "spearman_ties": stats.spearmanr(ties_x, ties_y),
    "spearman_long": stats.spearmanr(long_x, long_y),
    "spearman_missing": stats.spearmanr(*pairs(missing, plain_y)),
}


def row(values):
    return ", ".join("nan" if v != v else repr(float(v)) for v in values)


print("// Made by rank_tests_reference.py; not to be edited.\n#pragma once\n\n#include <limits>\n#include <vector>\n")
print("namespace expected {\n\nconstexpr double nan = std::numeric_limits<double>::quiet_NaN();")
print("struct Case {\n    double statistic, p_value;\n};\n\n// clang-format off")
for name in ("plain_x", "plain_y", "ties_x", "ties_y", "small", "long_x", "long_y", "missing"):
    print(f"inline const std::vector<double> {name}{{{row(globals()[name])}}};")
for name, result in cases.items():
    print(f"constexpr Case {name}{{{float(result[0])!r}, {float(result[1])!r}}};")
print("// clang-format on\n\n}  // namespace expected")
