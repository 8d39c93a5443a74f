#!/usr/bin/env python3
"""Prints the expected values of mcmc_diagnostics_test.cpp: R-hat and effective sizes of a small table.

Written from Vehtari et al. 2021 (Bayesian Analysis 16, 667-718), sections 3 and 4, with plain loops, so that it shares
nothing with the code under test. Needs the standard library alone.
"""
import math
from statistics import NormalDist


def table(n, c):
    """Autocorrelated chains of which the last is shifted, from a linear congruence: [c][n]."""
    state, chains = 12345, []
    for j in range(c):
        x, chain = 0.0, []
        for _ in range(n):
            state = (1103515245 * state + 12345) % 2**31
            x = 0.6 * x + state / 2**31 - 0.5
            chain.append(x + (0.2 if j == c - 1 else 0.0))
        chains.append(chain)
    return chains


def halves(chains):
    half = len(chains[0]) // 2
    return [c[:half] for c in chains] + [c[-half:] for c in chains]


def mean(v):
    return sum(v) / len(v)


def variance(v):
    m = mean(v)
    return sum((x - m) ** 2 for x in v) / (len(v) - 1)


def normal_scores(chains):
    flat = sorted(x for c in chains for x in c)
    score = {}
    for x in set(flat):
        first = flat.index(x) + 1
        rank = first + (flat.count(x) - 1) / 2
        score[x] = NormalDist().inv_cdf((rank - 3 / 8) / (len(flat) + 1 / 4))
    return [[score[x] for x in c] for c in chains]


def rhat(chains):
    n = len(chains[0])
    within = mean([variance(c) for c in chains])
    between = variance([mean(c) for c in chains])
    return math.sqrt(((n - 1) / n * within + between) / within)


def quantile(v, p):
    v = sorted(v)
    i = p * (len(v) - 1)
    low = int(i)
    return v[low] + (i - low) * (v[min(low + 1, len(v) - 1)] - v[low])


def effective(chains):
    n, c = len(chains[0]), len(chains)

    def covariance(chain, lag):
        m = mean(chain)
        return sum((chain[i] - m) * (chain[i + lag] - m) for i in range(n - lag)) / n

    within = mean([variance(x) for x in chains])
    total = (n - 1) / n * within + variance([mean(x) for x in chains])
    rho = [1 - (within - mean([covariance(x, lag) for x in chains])) / total for lag in range(n)]
    rho[0] = 1.0
    pairs = [rho[2 * t] + rho[2 * t + 1] for t in range(n // 2)]
    tau, least = -1.0, math.inf
    for p in pairs:
        if p <= 0:
            break
        least = min(least, p)
        tau += 2 * least
    return n * c / max(tau, 1 / math.log10(n * c))


def main():
    h = halves(table(60, 3))
    flat = [x for c in h for x in c]
    median = quantile(flat, 0.5)
    folded = [[abs(x - median) for x in c] for c in h]
    print("location R-hat %.12f" % rhat(normal_scores(h)))
    print("spread R-hat   %.12f" % rhat(normal_scores(folded)))
    print("bulk size      %.10f" % effective(normal_scores(h)))
    for p in (0.05, 0.95):
        q = quantile(flat, p)
        print("size at %.2f   %.10f" % (p, effective([[float(x <= q) for x in c] for c in h])))


if __name__ == "__main__":
    main()
