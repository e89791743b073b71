"use strict";
/* Linear programmes: min cost x, where A x = right and x >= 0. A homogeneous interior-point method
   (Xu, Hung and Ye 1996; steps of Andersen and Andersen 2000): it ends at the middle of all best
   points, or with a proof that there is none. */

const programme = (() => {
  const ROUNDS = 100;
  const SHORT = 0.99995; // of the way to the nearest bound
  const FINE = 1e-10; // what residuals may be
  const COARSE = 1e-7; // and still tell, where rounding allows no more
  const LEAST = 1e-30; // of a pivot, over its row: below it a row follows from others

  const dot = (a, b) => a.reduce((sum, value, i) => sum + value * b[i], 0);
  const norm = (a) => Math.sqrt(dot(a, a));

  /** Columns of a matrix as lists of [row, value]: what they do to x, and to y. */
  function times(columns, x, rows) {
    const found = new Float64Array(rows);
    columns.forEach((column, j) => { for (const [i, value] of column) found[i] += value * x[j]; });
    return found;
  }
  const transposed = (columns, y) =>
    Float64Array.from(columns, (column) => column.reduce((sum, [i, value]) => sum + value * y[i], 0));

  /** Solve with A D A' again and again: its Cholesky factor, rows that follow from others left out. */
  function normal(columns, d, rows) {
    const factor = Array.from({ length: rows }, (_, i) => new Float64Array(i + 1));
    columns.forEach((column, j) => {
      for (const [i, a] of column) for (const [k, b] of column) if (k <= i) factor[i][k] += a * d[j] * b;
    });
    for (let i = 0; i < rows; i++) {
      const [row, whole] = [factor[i], factor[i][i]];
      for (let k = 0; k <= i; k++) {
        let sum = row[k];
        for (let l = 0; l < k; l++) sum -= row[l] * factor[k][l];
        row[k] = k < i ? sum / factor[k][k] : sum > LEAST * whole ? Math.sqrt(sum) : Infinity;
      }
    }
    return (right) => {
      const y = Float64Array.from(right);
      for (let i = 0; i < rows; i++) {
        for (let k = 0; k < i; k++) y[i] -= factor[i][k] * y[k];
        y[i] /= factor[i][i];
      }
      for (let i = rows - 1; i >= 0; i--) {
        y[i] /= factor[i][i];
        for (let k = 0; k < i; k++) y[k] -= factor[i][k] * y[i];
      }
      return y;
    };
  }

  /** Find the best x, and y, the prices of `right`. `ends`: "best", "impossible" (then y proves it),
      "endless", or "open" where rounding hides it. */
  function solve(cost, columns, right) {
    const found = once(cost, columns, right);
    // A ray of ever better points may begin nowhere.
    const begins = found.ends === "endless" && once(cost.map(() => 0), columns, right);
    return begins && begins.ends !== "best" ? begins : found;
  }

  function once(cost, columns, right) {
    const [n, m] = [columns.length, right.length];
    let [x, z, y, tau, kappa] = [new Float64Array(n).fill(1), new Float64Array(n).fill(1), new Float64Array(m), 1, 1];
    const residuals = () => {
      const [ax, ay] = [times(columns, x, m), transposed(columns, y)];
      return {
        primal: Float64Array.from(right, (b, i) => b * tau - ax[i]),
        dual: Float64Array.from(cost, (c, j) => c * tau - ay[j] - z[j]),
        gap: dot(cost, x) - dot(right, y) + kappa,
        middle: (dot(x, z) + tau * kappa) / (n + 1),
      };
    };
    const [sizes, start] = [[norm(right), norm(cost)], residuals()];
    const first = { primal: Math.max(1, norm(start.primal)), dual: Math.max(1, norm(start.dual)), gap: Math.max(1, Math.abs(start.gap)) };
    /** What is told, and the size of residuals at which it is. */
    const told = (now) => {
      const [earned, spent] = [dot(right, y), dot(cost, x)];
      const best = Math.max(norm(now.primal) / tau / (1 + sizes[0]), norm(now.dual) / tau / (1 + sizes[1]),
        Math.abs(spent - earned) / (tau + Math.abs(earned)));
      const none = Math.max(norm(now.primal) / first.primal, norm(now.dual) / first.dual, Math.abs(now.gap) / first.gap, tau / Math.max(1, kappa));
      return best < none ? { ends: "best", size: best } : { ends: earned > -spent ? "impossible" : "endless", size: none };
    };
    let now = start;
    let found = { ends: "open", size: Infinity, x, y, scale: 1 };
    for (let round = 0; round < ROUNDS && found.size > FINE; round++) {
      const inverse = normal(columns, x.map((value, j) => value / z[j]), m);
      const both = (r1, r2) => {
        const scaled = r1.map((value, j) => (value * x[j]) / z[j]);
        const v = inverse(times(columns, scaled, m).map((value, i) => value + r2[i]));
        const back = transposed(columns, v);
        return [back.map((value, j) => (x[j] / z[j]) * (value - r1[j])), v];
      };
      const [p, q] = both(Float64Array.from(cost), right);
      let step = null;
      let gamma = 0;
      for (let pass = 0; pass < 2; pass++) {
        const eta = 1 - gamma;
        const target = x.map((value, j) => gamma * now.middle - value * z[j] - (step ? step.dx[j] * step.dz[j] : 0));
        const last = gamma * now.middle - tau * kappa - (step ? step.dtau * step.dkappa : 0);
        const [u, v] = both(now.dual.map((value, j) => eta * value - target[j] / x[j]), now.primal.map((value) => eta * value));
        const dtau = (eta * now.gap + last / tau + dot(cost, u) - dot(right, v)) / (kappa / tau - dot(cost, p) + dot(right, q));
        const dx = u.map((value, j) => value + p[j] * dtau);
        const dz = target.map((value, j) => (value - z[j] * dx[j]) / x[j]);
        const dkappa = (last - kappa * dtau) / tau;
        let far = 1;
        const keep = (value, change) => { if (change < 0) far = Math.min(far, (-value / change) * (pass ? SHORT : 1)); };
        x.forEach((value, j) => { keep(value, dx[j]); keep(z[j], dz[j]); });
        keep(tau, dtau);
        keep(kappa, dkappa);
        step = { dx, dz, dy: v.map((value, i) => value + q[i] * dtau), dtau, dkappa, far };
        gamma = (1 - far) ** 2 * Math.min(0.1, 1 - far);
      }
      const { far } = step;
      const go = (from, change) => from.map((value, j) => value + far * change[j]);
      const next = [go(x, step.dx), go(z, step.dz), go(y, step.dy), go([tau, kappa], [step.dtau, step.dkappa])];
      if (!next.every((each) => Number.isFinite(dot(each, each)))) break;
      [x, z, y, [tau, kappa]] = next;
      now = residuals();
      const here = told(now);
      // Rounding may spoil what comes after the best.
      if (here.size < found.size) found = { ...here, x, y, scale: here.ends === "best" ? tau : 1 };
    }
    const { ends, size, scale } = found;
    return { ends: size < COARSE ? ends : "open", x: found.x.map((value) => value / scale), y: found.y.map((value) => value / scale) };
  }

  return { solve };
})();
