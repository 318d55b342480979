"""Test functions of the literature on controlled random search: the three families of Levy and
Montalvo as given by Lucidi and Piccioni (1989), with about 5^n, 10^n and 15^n local minima.
All are zero only at x = 1, in the box [-10, 10]; evaluated in double."""
import numpy as np

BOX = 10.0


def levy(y):
    n, s = len(y), 10 * np.sin(np.pi * y)**2
    return np.pi / n * (s[0] + ((y[:-1] - 1)**2 * (1 + s[1:])).sum() + (y[-1] - 1)**2)


def minima5(x):
    return levy(1 + (np.asarray(x) - 1) / 4)


def minima10(x):
    return levy(np.asarray(x))


def minima15(x):
    x = np.asarray(x)
    s = np.sin(3 * np.pi * x)**2
    last = (x[-1] - 1)**2 * (1 + np.sin(2 * np.pi * x[-1])**2)
    return 0.1 * (s[0] + ((x[:-1] - 1)**2 * (1 + s[1:])).sum() + last)


FAMILIES = {"5^n": minima5, "10^n": minima10, "15^n": minima15}
#: Brachetti et al. (1997), their test function 7: evaluations of Price's algorithm with weighted
#: centroid until it ends, and with a quadratic model of the best points.
PUBLISHED = {2: (2181, 903), 4: (8088, 2374), 6: (16017, 3921), 8: (26718, 5427),
             10: (36838, 7081)}
