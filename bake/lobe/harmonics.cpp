// min Σⱼ (Σᵢ cᵢ Yᵢ(ωⱼ) − Tⱼ)²: normal equations G c = b with Gᵢₖ = Σⱼ Yᵢ Yₖ, bᵢ = Σⱼ Yᵢ Tⱼ. G is near (N/4π)·1 for directions of equal
// solid angle. Solving with G makes the fit exact for functions in the span of the Yᵢ; plain quadrature would be off by several per cent at
// N = 100. One Cholesky factor is used for all points (G. H. Golub, C. F. Van Loan, "Matrix Computations", 4th ed., section 4.2): the rows
// of G⁻¹Y become weights per direction.
#include "bake/lobe/harmonics.h"

#include <cmath>

#include "core/harmonics.h"
#include "core/parallel.h"

namespace cloudbake {

namespace {

using Matrix = std::vector<std::vector<double>>;

// The lower triangle L of G = L Lᵀ.
Matrix cholesky(Matrix g) {
  const size_t n = g.size();
  for (size_t i = 0; i < n; ++i)
    for (size_t k = 0; k <= i; ++k) {
      double sum = g[i][k];
      for (size_t m = 0; m < k; ++m) sum -= g[i][m] * g[k][m];
      g[i][k] = i == k ? std::sqrt(sum) : sum / g[k][k];
    }
  return g;
}

std::vector<double> solve(const Matrix& l, std::vector<double> b) {
  const size_t n = b.size();
  for (size_t i = 0; i < n; ++i) {
    for (size_t k = 0; k < i; ++k) b[i] -= l[i][k] * b[k];
    b[i] /= l[i][i];
  }
  for (size_t i = n; i-- > 0;) {
    for (size_t k = i + 1; k < n; ++k) b[i] -= l[k][i] * b[k];
    b[i] /= l[i][i];
  }
  return b;
}

// The weights of each direction: cᵢ = Σⱼ weights[j][i] Tⱼ.
std::vector<std::vector<double>> fitWeights(std::span<const Vec3> directions, size_t count) {
  Matrix gram(count, std::vector<double>(count, 0));
  std::vector<std::vector<double>> basis;
  for (const Vec3& direction : directions) {
    const auto values = evaluateHarmonics(direction);
    basis.emplace_back(values.begin(), values.begin() + ptrdiff_t(count));
    for (size_t i = 0; i < count; ++i)
      for (size_t k = 0; k < count; ++k) gram[i][k] += basis.back()[i] * basis.back()[k];
  }
  const Matrix factor = cholesky(std::move(gram));
  for (std::vector<double>& row : basis) row = solve(factor, std::move(row));
  return basis;
}

}  // namespace

std::vector<float> fitHarmonics(std::span<const Vec3> directions, std::span<const float> values, int order) {
  const size_t count = harmonicCount(order), points = values.size() / directions.size();
  const auto weights = fitWeights(directions, count);
  std::vector<float> coefficients(points * count);
  parallelFor(points, [&](size_t p) {
    std::array<double, kMaxHarmonics> sums{};
    for (size_t j = 0; j < directions.size(); ++j)
      for (size_t i = 0; i < count; ++i) sums[i] += weights[j][i] * double(values[p * directions.size() + j]);
    for (size_t i = 0; i < count; ++i) coefficients[p * count + i] = float(sums[i]);
  });
  return coefficients;
}

}  // namespace cloudbake
