#include "rodwake/granular/observe.hpp"

#include "cell_grid.hpp"
#include "periodic.hpp"

#include <cmath>

namespace rodwake::granular {

std::vector<std::complex<double>> local_psi6(const std::vector<double>& x, const std::vector<double>& y,
                                             double box, double cutoff) {
    const std::size_t count = x.size();
    Rows rows(4 * count, 0.0);
    for (std::size_t i = 0; i < count; ++i) {
        rows[4 * i] = x[i];
        rows[4 * i + 1] = y[i];
    }
    PairList near;
    near_pairs(rows, std::vector<double>(count, cutoff / 2.0), count, {}, box, 0.0, near);
    std::vector<std::complex<double>> psi(count);
    std::vector<int> neighbours(count, 0);
    for (const Pair& pair : near.pairs) {
        const std::complex<double> apart(nearest_image(x[pair.first] - x[pair.second], box),
                                         nearest_image(y[pair.first] - y[pair.second], box));
        const double size2 = std::norm(apart);
        if (size2 == 0.0)
            continue;
        const std::complex<double> twice = apart * apart / size2, bond = twice * twice * twice;
        for (const std::uint32_t i : {pair.first, pair.second}) {
            psi[i] += bond; // the same seen from either end: six is even
            ++neighbours[i];
        }
    }
    for (std::size_t i = 0; i < count; ++i)
        if (neighbours[i] > 0)
            psi[i] /= neighbours[i];
    return psi;
}

double global_psi6(const std::vector<double>& x, const std::vector<double>& y, double box, double cutoff) {
    std::complex<double> sum = 0.0;
    for (const std::complex<double>& psi : local_psi6(x, y, box, cutoff))
        sum += psi;
    return x.empty() ? 0.0 : std::abs(sum) / static_cast<double>(x.size());
}

} // namespace rodwake::granular
