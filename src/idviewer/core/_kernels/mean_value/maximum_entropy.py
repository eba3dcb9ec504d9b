"""Maximum entropy coordinates: priors of the vertices, and a safeguarded Newton method for each point.

Notation as in docs/coordinates.md: x_i = v_i - p the vertices as seen from a point p, m_i their priors,
w_i = m_i exp(-lambda . x_i) / Z the weights, mean = sum w_i x_i, which is to vanish. Everything is in units
of the bounding box's diagonal. Flat shapes have a third coordinate 0.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from idviewer.core._kernels.simd.options import OPTIONS, TINY

MEAN_LENGTH_TOLERANCE = 1e-13
"""Length of the mean at which Newton's method stops; the last step usually lands far below."""

MOST_EVALUATIONS = 200
"""Largest number of steps; some six to twenty are usual."""

FIRST_STEP_LENGTH = 16.0
"""Length of lambda's first step, roughly."""

LOG_Z_ERROR = 1e-14
"""Relative error of log Z."""

SUM_OPTIONS = {**OPTIONS, "fastmath": {"contract", "nsz", "reassoc"}}


@numba.njit(**OPTIONS)
def _edge_priors(x, edges, lengths, priors):  # type: ignore[no-untyped-def]
    """Log priors of a polygon's vertices: minus log rho_e of the two edges, rho_e = |a| + |b| - |b - a|.

    That is 2 (|a| |b| + a . b) / (|a| + |b| + |b - a|), and |a| |b| + a . b = (a x b)^2 / (|a| |b| - a . b).
    """
    priors[:] = 0.0
    for e in range(len(edges)):
        i, j = edges[e, 0], edges[e, 1]
        r_i = math.sqrt(x[0, i] * x[0, i] + x[1, i] * x[1, i])
        r_j = math.sqrt(x[0, j] * x[0, j] + x[1, j] * x[1, j])
        dot, product = x[0, i] * x[0, j] + x[1, i] * x[1, j], r_i * r_j
        cross = x[0, i] * x[1, j] - x[1, i] * x[0, j]
        sum_ = product + dot if dot > 0.0 else cross * cross / (product - dot)
        rho = math.log(2.0 * sum_ / (r_i + r_j + lengths[0, e]) + TINY)
        priors[i] -= rho
        priors[j] -= rho


@numba.njit(**OPTIONS)
def _side(s, q):  # type: ignore[no-untyped-def]
    """sqrt(s^2 + q), and what it is more than s without cancellation."""
    root = math.sqrt(s * s + q)
    return root, (q / (root + s) if s > 0.0 else root - s)


@numba.njit(**OPTIONS)
def _see_faces(p_0, p_1, p_2, c, seen):  # type: ignore[no-untyped-def]
    """Areas n_k of the triangles of p and each face's edges, and the factor (A / g)^3 / rho^2.

    A is the face's area, g = sum n_k, and rho = g - A is 0 on the face alone. n_k = sqrt(s_k^2 + q_k), where
    s_k is the signed area of the triangle's projection, q_k = (h |e_k| / 2)^2 and h the height of p over the
    face's plane; the s_k add up to A.

    Args:
        p_0, p_1, p_2: a point.
        c: (20, m), see `face_constants`.
        seen: (4, m) output.
    """
    for f in range(c.shape[1]):
        h = c[0, f] * p_0 + c[1, f] * p_1 + c[2, f] * p_2 - c[3, f]
        s_0 = c[4, f] * p_0 + c[5, f] * p_1 + c[6, f] * p_2 - c[7, f]
        s_1 = c[8, f] * p_0 + c[9, f] * p_1 + c[10, f] * p_2 - c[11, f]
        s_2 = c[12, f] * p_0 + c[13, f] * p_1 + c[14, f] * p_2 - c[15, f]
        n_0, more_0 = _side(s_0, h * h * c[16, f] + TINY)
        n_1, more_1 = _side(s_1, h * h * c[17, f] + TINY)
        n_2, more_2 = _side(s_2, h * h * c[18, f] + TINY)
        rho, ratio = more_0 + more_1 + more_2, c[19, f] / (n_0 + n_1 + n_2)
        seen[0, f], seen[1, f], seen[2, f] = n_0, n_1, n_2
        seen[3, f] = ratio * ratio * ratio / (rho * rho)


@numba.njit(**OPTIONS)
def _face_priors(p, faces, constants, seen, priors):  # type: ignore[no-untyped-def]
    """Log priors of a mesh's vertices: of m_i = sum over its faces of n_i (A / g)^3 / rho^2.

    n_i belongs to the edge opposite to the vertex.
    """
    _see_faces(p[0], p[1], p[2], constants, seen)
    priors[:] = TINY
    for f in range(len(faces)):
        factor = seen[3, f]
        priors[faces[f, 2]] += factor * seen[0, f]
        priors[faces[f, 0]] += factor * seen[1, f]
        priors[faces[f, 1]] += factor * seen[2, f]
    for i in range(len(priors)):
        priors[i] = math.log(priors[i])


@numba.njit(**SUM_OPTIONS)
def _sums(x, w, sums):  # type: ignore[no-untyped-def]
    """sum w_i, its first moments and its second ones."""
    total = m_0 = m_1 = m_2 = 0.0
    c_00 = c_01 = c_02 = c_11 = c_12 = c_22 = 0.0
    x_0, x_1, x_2 = x[0], x[1], x[2]
    for i in range(len(w)):
        a, b, c, weight = x_0[i], x_1[i], x_2[i], w[i]
        wa, wb, wc = weight * a, weight * b, weight * c
        total, m_0, m_1, m_2 = total + weight, m_0 + wa, m_1 + wb, m_2 + wc
        c_00, c_01, c_02 = c_00 + wa * a, c_01 + wa * b, c_02 + wa * c
        c_11, c_12, c_22 = c_11 + wb * b, c_12 + wb * c, c_22 + wc * c
    sums[0], sums[1], sums[2], sums[3] = total, m_0, m_1, m_2
    sums[4], sums[5], sums[6], sums[7], sums[8], sums[9] = c_00, c_01, c_02, c_11, c_12, c_22


@numba.njit(**OPTIONS)
def _exponents(x, priors, l_0, l_1, l_2, w):  # type: ignore[no-untyped-def]
    """Log weights into w; returns the largest."""
    x_0, x_1, x_2 = x[0], x[1], x[2]
    for i in range(len(w)):
        w[i] = priors[i] - (l_0 * x_0[i] + l_1 * x_1[i] + l_2 * x_2[i])
    top = -np.inf
    for i in range(len(w)):
        top = max(top, w[i])
    return top


@numba.njit(**OPTIONS)
def _evaluate(x, priors, multipliers, w, state):  # type: ignore[no-untyped-def]
    """Weights at some lambda, not normalised, and the state: sum, mean, covariance, log Z, |mean|."""
    top = _exponents(x, priors, multipliers[0], multipliers[1], multipliers[2], w)
    for i in range(len(w)):
        depth = w[i] - top
        w[i] = math.exp(depth) if depth > -700.0 else 0.0
    _sums(x, w, state)
    total = state[0]
    for k in range(1, 10):
        state[k] /= total
    m_0, m_1, m_2 = state[1], state[2], state[3]
    state[4] -= m_0 * m_0
    state[5] -= m_0 * m_1
    state[6] -= m_0 * m_2
    state[7] -= m_1 * m_1
    state[8] -= m_1 * m_2
    state[9] -= m_2 * m_2
    state[10] = top + math.log(total)
    state[11] = math.sqrt(m_0 * m_0 + m_1 * m_1 + m_2 * m_2)


@numba.njit(**OPTIONS)
def _newton_step(state, ridge, flat):  # type: ignore[no-untyped-def]
    """Solve (covariance + ridge) step = mean by Cholesky; and how much lower log Z should be there."""
    c_00, c_11 = max(state[4], 0.0) + ridge, max(state[7], 0.0) + ridge
    c_22 = 1.0 if flat else max(state[9], 0.0) + ridge
    r_0 = math.sqrt(c_00)
    r_01, r_02 = state[5] / r_0, state[6] / r_0
    r_1 = math.sqrt(max(c_11 - r_01 * r_01, 0.5 * ridge))
    r_12 = (state[8] - r_01 * r_02) / r_1
    r_2 = math.sqrt(max(c_22 - r_02 * r_02 - r_12 * r_12, 0.5 * ridge))
    y_0 = state[1] / r_0
    y_1 = (state[2] - r_01 * y_0) / r_1
    y_2 = (state[3] - r_02 * y_0 - r_12 * y_1) / r_2
    d_2 = y_2 / r_2
    d_1 = (y_1 - r_12 * d_2) / r_1
    d_0 = (y_0 - r_01 * d_1 - r_02 * d_2) / r_0
    return d_0, d_1, d_2, 0.5 * (y_0 * y_0 + y_1 * y_1 + y_2 * y_2)


@numba.njit(**OPTIONS)
def find_weights(x, priors, flat, w, state, trial):  # type: ignore[no-untyped-def]
    """Minimise log Z, which is convex in lambda; weights into w, not normalised.

    Newton steps with a ridge |mean| / radius, which bounds their length by the radius far away and vanishes
    where the method converges. A step has to lower log Z (Armijo); where that is rounding, the mean.

    Args:
        x: (3, n).
        priors: (n,) logarithms.
        flat: whether the third coordinate is 0.
        w: (n,) output.
        state, trial: (12,) workspace.

    Returns:
        Sum of the weights, the length of the mean, and the number of evaluations.
    """
    here, there = np.zeros(3), np.zeros(3)
    _evaluate(x, priors, here, w, state)
    radius, stale, done = FIRST_STEP_LENGTH, False, 1
    while done < MOST_EVALUATIONS and state[11] > MEAN_LENGTH_TOLERANCE:
        d_0, d_1, d_2, gain = _newton_step(state, state[11] / radius + TINY, flat)
        there[0], there[1], there[2] = here[0] + d_0, here[1] + d_1, here[2] + d_2
        _evaluate(x, priors, there, w, trial)
        done += 1
        noise = LOG_Z_ERROR * (1.0 + abs(state[10]))
        lower = state[10] - trial[10]
        stale = not (lower >= 0.1 * gain or (lower >= -noise and trial[11] < state[11]))
        if stale:
            if gain < 0.01 * noise:
                break
            radius = 0.25 * min(radius, math.sqrt(d_0 * d_0 + d_1 * d_1 + d_2 * d_2))
        else:
            if lower >= 0.5 * gain:
                radius *= 4.0
            here[:], state[:] = there, trial
    if stale:
        _evaluate(x, priors, here, w, state)
    return state[0], state[11], done


@numba.njit(parallel=True, cache=True, **OPTIONS)
def maximum_entropy(points, inside, vertices, elements, constants, result, residuals, steps):  # type: ignore[no-untyped-def]
    """Maximum entropy coordinates of points inside; Hormann and Sukumar 2008.

    Args:
        points: (p, 3).
        inside: (q,) indices of those that are inside and off the boundary.
        vertices: (3, n).
        elements: (e, 2) edges of a polygon or (m, 3) faces of a mesh.
        constants: (1, e) lengths of the edges, or (20, m); see `face_constants`.
        result: (p, n) output; the rows of the points inside.
        residuals: (q,) output; |sum w_i x_i|.
        steps: (q,) output; evaluations that it took.
    """
    count, flat = vertices.shape[1], elements.shape[1] == 2
    for place in numba.prange(len(inside)):
        p = inside[place]
        x, priors, state, trial = np.empty((3, count)), np.empty(count), np.empty(12), np.empty(12)
        for k in range(3):
            for i in range(count):
                x[k, i] = vertices[k, i] - points[p, k]
        if flat:
            _edge_priors(x, elements, constants, priors)
        else:
            _face_priors(points[p], elements, constants, np.empty((4, len(elements))), priors)
        total, residuals[place], steps[place] = find_weights(x, priors, flat, result[p], state, trial)
        for i in range(count):
            result[p, i] /= total
