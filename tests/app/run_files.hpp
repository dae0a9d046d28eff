#pragma once
// Ways to look at the files of a run, and what its manifest does not tell of them.

#include "store/scratch.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace app_test {

namespace fs = std::filesystem;

inline nlohmann::json json_of(const fs::path& file) {
    return nlohmann::json::parse(store_test::content(file));
}

/// The names in the first line of a CSV file that is no comment.
inline std::vector<std::string> header_of(const fs::path& file) {
    std::istringstream lines(store_test::content(file));
    std::string line;
    while (std::getline(lines, line) && line.starts_with('#')) {
    }
    std::vector<std::string> names;
    std::istringstream fields(line);
    for (std::string name; std::getline(fields, name, ',');)
        names.push_back(name);
    return names;
}

/// Files that the manifest does not know, and columns that it does not tell of.
inline std::set<std::string> undescribed(const fs::path& folder) {
    std::set<std::string> missing;
    const nlohmann::json files = json_of(folder / "manifest.json").at("files");
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const std::string name = entry.path().lexically_relative(folder).generic_string();
        if (!entry.is_regular_file())
            continue;
        if (!files.contains(name))
            missing.insert(name);
        else if (name.ends_with(".csv"))
            for (const std::string& column : header_of(entry.path())) {
                const auto& columns = files[name].at("columns");
                if (std::ranges::none_of(columns, [&](const auto& c) { return c.at("name") == column; }))
                    missing.insert(name + ":" + column);
            }
    }
    return missing;
}

} // namespace app_test
