// The Beta distribution of a success rate: its density, and what it is sure of.

// ln Gamma(x), x > 0: Lanczos' approximation with g = 7, n = 9.
function logGamma(x: number): number {
  const c = [
    0.99999999999980993, 676.5203681218851, -1259.1392167224028, 771.32342877765313,
    -176.61502916214059, 12.507343278686905, -0.13857109526572012, 9.9843695780195716e-6,
    1.5056327351493116e-7,
  ]
  if (x < 0.5) return Math.log(Math.PI / Math.sin(Math.PI * x)) - logGamma(1 - x)
  const t = x + 6.5
  const sum = c.slice(1).reduce((s, ci, i) => s + ci / (x + i), c[0])
  return 0.5 * Math.log(2 * Math.PI) + (x - 0.5) * Math.log(t) - t + Math.log(sum)
}

// Its poles at 0 and 1, where alpha or beta is below 1, are cut off beside them.
export function density(p: number, alpha: number, beta: number): number {
  const x = Math.min(1 - 1e-3, Math.max(1e-3, p))
  const logB = logGamma(alpha) + logGamma(beta) - logGamma(alpha + beta)
  return Math.exp((alpha - 1) * Math.log(x) + (beta - 1) * Math.log(1 - x) - logB)
}

// The interval that holds 90 % of the probability, 5 % on either side; by the midpoint rule.
export function beta(alpha: number, beta: number): { interval: [number, number] } {
  const steps = 400
  const weights = Array.from({ length: steps }, (_, i) => density((i + 0.5) / steps, alpha, beta))
  const total = weights.reduce((sum, w) => sum + w, 0)
  const at = (share: number) => {
    let sum = 0
    for (let i = 0; i < steps; ++i) {
      sum += weights[i] / total
      if (sum >= share) return (i + 0.5) / steps
    }
    return 1
  }
  return { interval: [at(0.05), at(0.95)] }
}
