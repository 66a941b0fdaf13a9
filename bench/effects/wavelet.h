// The orthonormal wavelet transform with four coefficients of I. Daubechies, "Orthonormal bases of compactly supported
// wavelets", Comm. Pure Appl. Math. 41, 1988; periodic, lengths of a power of two.
#pragma once

#include <vector>

namespace sparsha::bench {

[[nodiscard]] std::vector<double> wavelet_transform(std::vector<double> samples);
[[nodiscard]] std::vector<double> inverse_wavelet_transform(std::vector<double> coefficients);

}  // namespace sparsha::bench
