#pragma once
// Described rows as a CSV file, and their columns for the catalogue.

#include "catalogue.hpp"
#include "rodwake/store/csv.hpp"

#include <cmath>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace rodwake::app {

template<Described Record, class Get>
using ValueIn = std::remove_cvref_t<decltype(std::declval<Field<Get>>().of(std::declval<Record>()))>;

/// Blocks of columns side by side: of each kind of rows as many. An Estimate has two columns, the second of
/// its errors.
class RecordTable {
public:
    /// Their names end with `behind`: the number of a rod.
    template<Described Row>
    void add(const std::vector<Row>& rows, const std::string& behind = "") {
        for_each_field<Row>([&]<class Get>(const Field<Get>& field) {
            const auto add_column = [&](const std::string& name, const auto& number) {
                names_.push_back(name + behind);
                std::ranges::transform(rows, std::back_inserter(columns_.emplace_back()), number);
            };
            const std::string name(field.name);
            if constexpr (std::is_same_v<ValueIn<Row, Get>, Estimate>) {
                const auto known = [&](const Row& row, double Estimate::*part) {
                    const Estimate& e = field.of(row);
                    return e.count > 0 ? e.*part : std::nan("");
                };
                add_column(name, [&](const Row& row) { return known(row, &Estimate::value); });
                add_column(name + "_error", [&](const Row& row) { return known(row, &Estimate::error); });
            } else {
                add_column(name, [&](const Row& row) { return static_cast<double>(field.of(row)); });
            }
        });
    }

    /// A record of whole columns.
    template<Described Columns>
    void add(const Columns& columns) {
        for_each_field<Columns>([&](const auto& field) {
            names_.emplace_back(field.name);
            columns_.push_back(field.of(columns));
        });
    }

    std::string csv() const { return store::to_csv(names_, columns_); }

private:
    std::vector<std::string> names_;
    std::vector<std::vector<double>> columns_;
};

/// Makes the table of a list of described rows, or of a record of columns.
template<class Rows>
std::string csv_of(const Rows& rows) {
    RecordTable table;
    table.add(rows);
    return table.csv();
}

/// Appends what the catalogue tells of such rows, but for names that are there.
template<Described Row>
void add_columns(std::vector<ColumnInfo>& columns, const std::string& behind = "") {
    for_each_field<Row>([&]<class Get>(const Field<Get>& field) {
        const std::string name = std::string(field.name) + behind;
        if (std::ranges::find(columns, name, &ColumnInfo::name) == columns.end())
            columns.push_back(column_info(name, field.info.unit, field.info.meaning));
        if (std::is_same_v<ValueIn<Row, Get>, Estimate>)
            columns.push_back(
                column_info(std::string(field.name) + "_error" + behind, field.info.unit, "standard error"));
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
        constexpr bool list = requires(const Record& record) { field.of(record).size(); };
        columns.push_back(
            column_info(std::string(field.name) + (list ? "<k>" : ""), field.info.unit, field.info.meaning));
    });
}

/// Appends the numbers of a JSON file, "rods.<k>.force", or all its values: those without a unit are texts.
template<Described Record, bool all = false>
void add_values(std::vector<ColumnInfo>& values, const std::string& before = "") {
    for_each_field<Record>([&]<class Get>(const Field<Get>& field) {
        using Member = ValueIn<Record, Get>;
        const std::string name = before + std::string(field.name);
        if constexpr (Described<Member>)
            add_values<Member, all>(values, name + ".");
        else if constexpr (requires { requires Described<typename Member::value_type>; })
            add_values<typename Member::value_type, all>(
                values, name + (requires(Member m) { m.size(); } ? ".<k>." : "."));
        else if constexpr (requires { requires Described<typename Member::value_type::second_type>; })
            add_values<typename Member::value_type::second_type, all>(values, name + ".<k>.");
        else if constexpr (requires { requires Described<std::variant_alternative_t<1, Member>>; })
            add_values<std::variant_alternative_t<1, Member>, all>(values, name + ".");
        else if (all || !field.info.unit.empty())
            values.push_back(column_info(name, field.info.unit, field.info.meaning, field.info.row));
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

/// The numbers of a JSON file, or all its values.
template<Described Record, bool all = false>
std::span<const ColumnInfo> values_of() {
    static const std::vector<ColumnInfo> values = [] {
        std::vector<ColumnInfo> listed;
        add_values<Record, all>(listed);
        return listed;
    }();
    return values;
}

} // namespace rodwake::app
