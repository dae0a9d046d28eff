#include "run_tables.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/store/csv.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>

namespace rodwake::app {

RunTables run_tables(const std::filesystem::path& folder) {
    return {[file = folder / "summary.json"](const std::string& name, const std::string& what) {
                std::ifstream in(file);
                try {
                    const nlohmann::json summary = nlohmann::json::parse(in, nullptr, false);
                    std::string pointer = "/" + name;
                    std::ranges::replace(pointer, '.', '/');
                    const nlohmann::json& found = summary.at(nlohmann::json::json_pointer(pointer));
                    return found.is_boolean() ? double(found.get<bool>()) : found.get<double>();
                } catch (const nlohmann::json::exception&) {
                    throw InputError(
                        fmt::format("{}: no {}; make the granular run again", file.string(), what));
                }
            },
            [file = folder / "tracks.csv"](const std::vector<std::string>& names) {
                const store::Table table = store::read_csv(file, names);
                std::vector<Column> columns;
                columns.reserve(names.size());
                for (const std::string& name : names)
                    columns.push_back(*table.find(name));
                return columns;
            }};
}

} // namespace rodwake::app
