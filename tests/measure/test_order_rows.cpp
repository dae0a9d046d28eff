// The vectorised part of the pair loop gives the bits of the plain loop on every instruction set.

#include "measure/pair_counts.hpp"
#include "rodwake/core/rng.hpp"

#include <catch2/catch.hpp>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace rodwake;
using namespace rodwake::measure;

namespace {

struct Row {
    std::vector<std::int32_t> bin;
    std::vector<double> order;

    bool operator==(const Row&) const = default;
};

/// x, y, re, im of beads, with room for whole vectors.
using Columns = std::vector<std::vector<double>>;

Columns random_columns(std::size_t count, double box) {
    RandomStream random(31);
    Columns c(4, std::vector<double>(count + padding, 0.0));
    for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t i = 0; i < count; ++i)
            c[k][i] = k < 2 ? random.uniform(0.0, box) : random.uniform(-1.0, 1.0);
    return c;
}

Row vector_row(const Columns& c, std::size_t i, std::size_t count, double box, double per_bin) {
    Row row{std::vector<std::int32_t>(count + padding), std::vector<double>(count + padding)};
    fill_pair_row({c[0].data(), c[1].data(), c[2].data(), c[3].data()}, i, count, box, per_bin,
                  row.bin.data(), row.order.data());
    row.bin.resize(count);
    row.order.resize(count);
    return row;
}

Row plain_row(const Columns& c, std::size_t i, std::size_t count, double box, double per_bin) {
    const auto apart = [box](double a, double b) { return std::min(std::abs(a - b), box - std::abs(a - b)); };
    Row row;
    for (std::size_t j = i + 1; j <= i + count; ++j) {
        const double dx = apart(c[0][j], c[0][i]), dy = apart(c[1][j], c[1][i]);
        row.bin.push_back(static_cast<std::int32_t>(std::sqrt(dx * dx + dy * dy) * per_bin));
        row.order.push_back(c[2][j] * c[2][i] + c[3][j] * c[3][i]);
    }
    return row;
}

template<class Test>
int on_every_target(const Test& test) {
    int targets = 0;
    const auto all = hwy::SupportedTargets();
    for (auto left = all; left != 0; left &= left - 1) {
        const auto target = left & -left;
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(target);
        test();
        ++targets;
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return targets;
}

} // namespace

TEST_CASE("rows of pairs are the same to the bit on every instruction set", "[order]") {
    const double box = 3.3;
    Columns c = random_columns(70, box);
    for (const std::size_t i : {0, 1, 40, 66, 68}) {
        const std::size_t count = 69 - i;
        const Row wanted = plain_row(c, i, count, box, 17.0);
        const int targets = on_every_target([&] { CHECK(vector_row(c, i, count, box, 17.0) == wanted); });
        CHECK(targets >= 1);
    }
    c[0][5] = std::nextafter(c[0][5] + 0.2, 0.0); // what is compared can tell
    c[2][6] += 1e-14;                             // a few units in the last place of the product
    const Row before = plain_row(random_columns(70, box), 0, 69, box, 17.0),
              after = vector_row(c, 0, 69, box, 17.0);
    CHECK(after.bin != before.bin);
    CHECK(after.order != before.order);
}
