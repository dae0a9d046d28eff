// The field, and the oracle, against the reference table.

#include "error_norm.hpp"
#include "reference_table.hpp"

#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

using namespace rodwake;
using namespace rodwake::oracle;

namespace {

const std::string path = RODWAKE_TEST_DATA "/elastic_field.csv";

Real distance(const std::vector<Real>& a, const std::vector<Real>& b) {
    Real sum = 0, scale = 0;
    for (std::size_t k = 0; k < b.size(); ++k) {
        sum += (a[k] - b[k]) * (a[k] - b[k]);
        scale += b[k] * b[k];
    }
    return scale == 0 ? sqrt(sum) : sqrt(sum / scale);
}

elastic::FieldValues field_at(const Point& p) {
    return elastic::Field({.eta = p.eta, .xi = p.xi}).at(p.x, p.y, everything);
}

} // namespace

TEST_CASE("the field agrees with the reference table at every point") {
    const std::vector<ReferenceRow> rows = reference_table(path);
    REQUIRE(rows.size() == 320);
    Worst worst;
    for (const ReferenceRow& row : rows)
        for (int k = 0; k < plain_quantities; ++k) {
            const auto q = static_cast<Quantity>(k);
            worst.include(q, relative_error(components(field_at(row.point), q), components(row, q)),
                          row.point);
        }
    for (int k = 0; k < plain_quantities; ++k) {
        CAPTURE(name(static_cast<Quantity>(k)), worst.at[k].x, worst.at[k].y, worst.at[k].xi,
                worst.at[k].eta);
        CHECK(worst.error[k] <= 2e-13); // the header's guarantee
    }
}

TEST_CASE("the oracle agrees with the reference table to its 25 digits") {
    for (const ReferenceRow& row : reference_table(path)) {
        const Field exact(row.point);
        for (int k = 0; k < plain_quantities; ++k) {
            const auto q = static_cast<Quantity>(k);
            CAPTURE(name(q), row.point.x, row.point.y);
            CHECK(distance(components(exact, q), components(row, q)) <
                  1e-24); // half a unit of digit 25, two of them
        }
    }
}

TEST_CASE("a swapped component of the reference is noticed") {
    ReferenceRow row = reference_table(path).front();
    const std::vector<double> got = components(field_at(row.point), Quantity::displacement);
    std::swap(row.numbers[0], row.numbers[1]);
    CHECK(relative_error(got, components(row, Quantity::displacement)) > 1e-3); // far above any rounding
}

TEST_CASE("a reference table that is missing or damaged is an error") {
    CHECK_THROWS_AS(reference_table(RODWAKE_TEST_DATA "/no_such_file.csv"), InputError);
    const auto damaged = [](const std::string& row) {
        const std::filesystem::path file =
            std::filesystem::temp_directory_path() / "rodwake_damaged_reference.csv";
        std::ofstream(file) << "# comment\nheader\n" << row << '\n';
        return file.string();
    };
    CHECK_THROWS_AS(reference_table(damaged("1,2,3")), InputError);
    CHECK_THROWS_AS(reference_table(damaged("1,2,3,4,5,6,7,8,9,10,11,12,13,14,x")), InputError);
    CHECK(reference_table(damaged("1,2,3,4,5,6,7,8,9,10,11,12,13,14,15")).size() == 1);
    ReferenceRow row;
    CHECK_THROWS_AS(components(row, Quantity::strain_gradients), InputError);
}
