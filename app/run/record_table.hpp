#pragma once
// Described rows as a CSV file, and their columns for the catalogue.

#include "catalogue.hpp"
#include "rodwake/store/csv.hpp"

#include <string>
#include <vector>

namespace rodwake::app {

/// Blocks of columns side by side: of each kind of rows as many.
class RecordTable {
public:
    /// Their names end with `behind`: the number of a rod.
    template<Described Row>
    void add(const std::vector<Row>& rows, const std::string& behind = "") {
        for_each_field<Row>([&](const auto& field) {
            names_.push_back(std::string(field.name) + behind);
            std::vector<double>& column = columns_.emplace_back();
            column.reserve(rows.size());
            for (const Row& row : rows)
                column.push_back(static_cast<double>(row.*field.member));
        });
    }

    std::string csv() const { return store::to_csv(names_, columns_); }

private:
    std::vector<std::string> names_;
    std::vector<std::vector<double>> columns_;
};

template<Described Row>
std::string csv_of(const std::vector<Row>& rows) {
    RecordTable table;
    table.add(rows);
    return table.csv();
}

/// Appends what the catalogue tells of such rows, but for names that are there.
template<Described Row>
void add_columns(std::vector<ColumnInfo>& columns, const std::string& behind = "") {
    for_each_field<Row>([&](const auto& field) {
        const std::string name = std::string(field.name) + behind;
        if (std::ranges::find(columns, name, &ColumnInfo::name) == columns.end())
            columns.push_back(column_info(name, field.info.unit, field.info.meaning));
    });
}

/// "turn1": the name and suffix that for_each_number gives.
inline std::string numbered(std::string_view name, int suffix) {
    return suffix < 0 ? std::string(name) : std::string(name) + std::to_string(suffix);
}

/// Appends the columns of for_each_number, "turn<k>" for a list.
template<Described Record>
void add_number_columns(std::vector<ColumnInfo>& columns) {
    for_each_field<Record>([&](const auto& field) {
        constexpr bool list = requires(const Record& record) { (record.*field.member).size(); };
        columns.push_back(
            column_info(std::string(field.name) + (list ? "<k>" : ""), field.info.unit, field.info.meaning));
    });
}

/// Appends the numbers of a JSON file, "rods.<k>.force"; what is in it without a unit is no number.
template<Described Record>
void add_values(std::vector<ColumnInfo>& values, const std::string& before = "") {
    for_each_field<Record>([&](const auto& field) {
        using Member = std::remove_cvref_t<decltype(std::declval<Record>().*field.member)>;
        const std::string name = before + std::string(field.name);
        if constexpr (Described<Member>)
            add_values<Member>(values, name + ".");
        else if constexpr (requires { requires Described<typename Member::value_type>; })
            add_values<typename Member::value_type>(
                values, name + (requires(Member m) { m.size(); } ? ".<k>." : "."));
        else if (!field.info.unit.empty())
            values.push_back(column_info(name, field.info.unit, field.info.meaning));
    });
}

/// Rows of which a table has a block of columns a rod, a comparison.
template<Described Row>
struct Each {};

template<class Row>
struct AddColumns {
    static void to(std::vector<ColumnInfo>& columns) { add_columns<Row>(columns); }
};
template<class Row>
struct AddColumns<Each<Row>> {
    static void to(std::vector<ColumnInfo>& columns) { add_columns<Row>(columns, "<k>"); }
};

/// Of a table of such blocks, side by side.
template<class... Rows>
std::span<const ColumnInfo> columns_of() {
    static const std::vector<ColumnInfo> columns = [] {
        std::vector<ColumnInfo> all;
        (AddColumns<Rows>::to(all), ...);
        return all;
    }();
    return columns;
}

/// The numbers of a JSON file.
template<Described Record>
std::span<const ColumnInfo> values_of() {
    static const std::vector<ColumnInfo> values = [] {
        std::vector<ColumnInfo> all;
        add_values<Record>(all);
        return all;
    }();
    return values;
}

} // namespace rodwake::app
