#include "reference_table.hpp"

#include "rodwake/core/error.hpp"

#include <fstream>
#include <sstream>

namespace rodwake::oracle {

namespace {

constexpr std::size_t columns = 15;

ReferenceRow parse(const std::string& line) {
    std::istringstream in(line);
    std::vector<std::string> cells;
    for (std::string cell; std::getline(in, cell, ',');)
        cells.push_back(cell);
    if (cells.size() != columns)
        throw InputError("reference row with " + std::to_string(cells.size()) + " columns: " + line);
    try {
        ReferenceRow row{{std::stod(cells[0]), std::stod(cells[1]), std::stod(cells[2]), std::stod(cells[3])},
                         {}};
        for (std::size_t k = 4; k < columns; ++k)
            row.numbers.emplace_back(cells[k]);
        return row;
    } catch (const std::exception& e) {
        throw InputError("reference row that does not parse (" + std::string(e.what()) + "): " + line);
    }
}

} // namespace

std::vector<ReferenceRow> reference_table(const std::string& path) {
    std::ifstream in(path);
    if (!in)
        throw InputError("no reference table at " + path);
    std::vector<ReferenceRow> rows;
    bool header = true;
    for (std::string line; std::getline(in, line);) {
        if (line.empty() || line[0] == '#')
            continue;
        if (!header)
            rows.push_back(parse(line));
        header = false;
    }
    return rows;
}

std::vector<Real> components(const ReferenceRow& row, Quantity q) {
    const std::vector<Real>& n = row.numbers;
    switch (q) {
    case Quantity::displacement:
        return {n[0], n[1]};
    case Quantity::strain:
        return {n[2], n[3], n[3], n[4]};
    case Quantity::laplacian:
        return {n[5], n[6]};
    case Quantity::gradient_of_trace:
        return {n[7], n[8]};
    case Quantity::dipole:
        return {n[9], n[10]};
    default:
        throw InputError("the reference table holds no " + name(q));
    }
}

} // namespace rodwake::oracle
