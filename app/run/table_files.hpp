#pragma once
// Tables of wakes as bytes, every bit under a checksum (store/block_file.hpp).

#include "rodwake/elastic/periodic_table.hpp"
#include "rodwake/elastic/plane_table.hpp"

#include <string>
#include <string_view>

namespace rodwake::app {

std::string encode(const elastic::PlaneTable& table);
std::string encode(const elastic::PeriodicTableData& table);

/// PlaneTable or PeriodicTableData. Throws InputError, with the name of the file, for bytes that are none.
template<class Table>
Table decode(std::string_view bytes, const std::string& file);
template<>
elastic::PlaneTable decode(std::string_view bytes, const std::string& file);
template<>
elastic::PeriodicTableData decode(std::string_view bytes, const std::string& file);

} // namespace rodwake::app
