#pragma once
// How many digits of a batched sum are wanted.

namespace rodwake::elastic {

/// Errors of one source at one point, relative to the norm; 200000 points, eta in [0.1, 100], r/xi in [0.005,
/// 80] (studies/reports/elastic.md). The largest stand beside the rod at eta near 100, where parts cancel,
/// for the strain, and near the curve ahead on which lap U vanishes. Tests hold 1.5e-13, 1e-7 and 1e-3 for
/// the strain.
///
///                strain: median, 99 %, largest    polar vectors: 99 %, largest
///     full       4e-16, 4e-15, 8e-14              6e-15, 2e-12
///     fine       4e-11, 1e-9, 3e-8                3e-10, 4e-7
///     single     4e-7, 1.2e-5, 5e-4               3e-6, 3e-3
///
/// (build/dev/tests/test_elastic "errors of the accuracies*")
///
/// `single` works in single precision with twice the lanes (sums over more than 64 sources, or over tiles of
/// all pairs, are in double). There a field is 0 where it has decayed by more than exp(-40) = 4e-18, and
/// values must be within 1e-30 to 1e30: choose a length unit near xi.
enum class Accuracy { full, fine, single };

} // namespace rodwake::elastic
