#pragma once
// psi_6 of each bead with the number of its neighbours.

#include <complex>
#include <cstddef>
#include <vector>

namespace rodwake::measure {

struct LocalOrder {
    std::vector<std::complex<double>> psi; ///< 0 without neighbours
    std::vector<int> neighbours;

    double mean_size() const; ///< of |psi|
    double mean_neighbours() const;
    double global() const; ///< |mean of psi|
};

/// Places in [0, box), else InputError; 0 < cutoff <= box/2.
LocalOrder order_by_cutoff(const std::vector<double>& x, const std::vector<double>& y, double box,
                           double cutoff);
LocalOrder order_by_delaunay(const std::vector<double>& x, const std::vector<double>& y, double box);

} // namespace rodwake::measure
