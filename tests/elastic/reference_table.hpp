#pragma once
// tests/data/elastic_field.csv: the reference field, 25 digits.

#include "oracle.hpp"

#include <string>
#include <vector>

namespace rodwake::oracle {

struct ReferenceRow {
    Point point;
    std::vector<Real> numbers; ///< Ux .. dipUy, as in the file's header
};

/// Every row; throws InputError on a missing file, a wrong number of columns or a number that does not parse.
std::vector<ReferenceRow> reference_table(const std::string& path);

/// One of the five plain quantities of a row, with the components of components(field, q).
std::vector<Real> components(const ReferenceRow& row, Quantity q);

} // namespace rodwake::oracle
