// Described results: what follows from a description, and that a wrong one is seen.

#include "bed/measure_kind.hpp"
#include "rodwake/app/describe.hpp"
#include "rodwake/scene/document.hpp"
#include "run/catalogue.hpp"
#include "run/record_json.hpp"
#include "run/record_table.hpp"
#include "theory/theory_records.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>

using namespace rodwake;

namespace {

using namespace rodwake;
using namespace rodwake::app;

struct Part {
    double width = 0.0;

    static constexpr auto fields() { return std::tuple{field("width", &Part::width, {"m", "of the part"})}; }
};

struct Whole {
    std::string name;
    double length = 0.0, depth = std::numeric_limits<double>::quiet_NaN();
    bool is_good = false;
    std::int64_t count = 0;
    Part part;
    std::vector<Part> parts;
    std::optional<Part> more;
    std::variant<std::monostate, double> other;
    Estimate mean;

    static constexpr auto fields() {
        using R = Whole;
        return std::tuple{field("name", &R::name, {"", "what it is called"}),
                          field("length", &R::length, {"a", "of it"}),
                          field("depth", &R::depth, {"a", "of it; empty: unknown"}),
                          field("is_good", &R::is_good, {"", "whether it is"}),
                          field("count", &R::count, {"1", "of them"}),
                          field("part", &R::part, {"", "a part"}),
                          field("parts", &R::parts, {"", "parts"}),
                          field("more", &R::more, {"", "a part that may be absent"}),
                          field("other", &R::other, {"s", "null where there is none"}),
                          field("mean", &R::mean, {"1", "a mean"})};
    }
};

/// With a function in place of a member, and an error.
struct Speed {
    double value = 0.0;
    Estimate mean;

    static constexpr auto fields() {
        return std::tuple{
            field("double", {"m/s", "twice the value"}, [](const Speed& s) { return 2.0 * s.value; }),
            field("mean", &Speed::mean, {"m/s", "a mean"})};
    }
};

/// Whole columns.
struct Lengths {
    std::vector<double> length;

    static constexpr auto fields() {
        return std::tuple{field("length", &Lengths::length, {"m", "of each"}),
                          field("half", {"m", "half of it"}, [](const Lengths& l) {
                              std::vector<double> half = l.length;
                              for (double& value : half)
                                  value *= 0.5;
                              return half;
                          })};
    }
};

Whole example() {
    Whole whole;
    whole.name = "one";
    whole.length = 0.1;
    whole.is_good = true;
    whole.count = 3;
    whole.part.width = 2.0;
    whole.parts = {{3.0}, {4.0}};
    whole.mean = {1.5, 0.5, 4};
    return whole;
}

/// Of nothing but what read_record takes.
struct Numbers {
    std::string name;
    double length = 0.0, depth = unknown_error;
    std::vector<Part> parts;
    Part part{7.0};
    std::optional<Part> more;

    static constexpr auto fields() {
        using R = Numbers;
        return std::tuple{field("name", &R::name, {"", "what it is called"}),
                          field("length", &R::length, {"a", "of it"}),
                          field("depth", &R::depth, {"a", "of it"}),
                          field("parts", &R::parts, {"", "parts"}),
                          field("part", &R::part, {"", "a part"}),
                          field("more", &R::more, {"", "may be absent"})};
    }
};

} // namespace

TEST_CASE("A described result is JSON in the order of its description", "[record]") {
    Whole whole = example();
    CHECK(
        record_json(whole).dump() ==
        R"({"name":"one","length":0.1,"depth":null,"is_good":true,"count":3,"part":{"width":2.0},)"
        R"("parts":[{"width":3.0},{"width":4.0}],"other":null,"mean":{"value":1.5,"error":0.5,"samples":4}})");
    whole.more = Part{5.0};
    whole.other = 6.0;
    const auto json = record_json(whole);
    CHECK(json.at("more").at("width") == 5.0);
    CHECK(json.at("other") == 6.0);
}

TEST_CASE("A described result is read back, and what is missing is reported", "[record]") {
    const Numbers written{"one", 0.1, std::nan(""), {{3.0}, {4.0}}, {2.0}, Part{5.0}};
    const nlohmann::json json = nlohmann::json::parse(record_json(written).dump());
    Numbers read;
    read_record(json, read);
    CHECK(read.name == "one");
    CHECK(read.length == 0.1);
    CHECK(std::isnan(read.depth));
    REQUIRE(read.parts.size() == 2);
    CHECK(read.parts[1].width == 4.0);
    CHECK(read.part.width == 2.0);
    CHECK(read.more.value().width == 5.0);

    nlohmann::json earlier = json;
    earlier.erase("part");
    earlier.erase("more");
    Numbers kept;
    read_record(earlier, kept);
    CHECK(kept.part.width == 7.0);
    CHECK_FALSE(kept.more);
    nlohmann::json unknown = json;
    unknown["length"] = nullptr; // which has to be known
    Numbers nothing;
    CHECK_THROWS_AS(read_record(unknown, nothing), nlohmann::json::exception);
    for (const char* name : {"name", "length", "depth", "parts"}) {
        nlohmann::json wrong = json;
        wrong.erase(name);
        Numbers none;
        CHECK_THROWS_AS(read_record(wrong, none), nlohmann::json::exception);
        wrong[name] = {{"another", "kind"}};
        CHECK_THROWS_AS(read_record(wrong, none), nlohmann::json::exception);
    }
}

TEST_CASE("Described rows are blocks of columns, NaN is an empty field", "[record]") {
    RecordTable table;
    table.add(std::vector<Part>{{1.0}, {2.0}});
    table.add(std::vector<Part>{{3.0}, {std::nan("")}}, "0");
    CHECK(table.csv() == "width,width0\n1,3\n2,\n");
    CHECK(csv_of(std::vector<Part>{{0.1}}) == "width\n0.10000000000000001\n");
    std::vector<ColumnInfo> columns;
    add_columns<Part>(columns);
    add_columns<Part>(columns); // known by now
    add_columns<Part>(columns, "<k>");
    REQUIRE(columns.size() == 2);
    CHECK(columns[1].name == "width<k>");
    CHECK(columns[1].unit == "m");
    CHECK(csv_of(std::vector<Speed>{{1.0, {}}, {0.0, {2.0, 0.5, 3}}}) ==
          "double,mean,mean_error\n2,,\n0,2,0.5\n");
    CHECK(columns_of<Speed>()[2].meaning == "standard error");
    CHECK(csv_of(Lengths{{1.0, 2.0}}) == "length,half\n1,0.5\n2,1\n");
}

TEST_CASE("Numbers of a described result have their place in the file", "[record]") {
    std::vector<std::string_view> names;
    for (const ColumnInfo& value : values_of<Whole>())
        names.push_back(value.name);
    CHECK(names == std::vector<std::string_view>{"length", "depth", "count", "part.width", "parts.<k>.width",
                                                 "more.width", "other", "mean"});
}

TEST_CASE("Every column and value of every file has a known unit and a meaning", "[record]") {
    std::size_t reported = 0;
    for (const FileKind& kind : file_kinds())
        for (const ColumnInfo& column : kind.columns) {
            INFO(kind.pattern << ": " << column.name << " in " << column.unit);
            CHECK(is_unit(column.unit));
            CHECK_FALSE(column.meaning.empty());
            ++reported;
        }
    CHECK(reported > 300);
    CHECK_FALSE(is_unit("{lenght}"));
    CHECK_FALSE(is_unit(""));
}

TEST_CASE("Endings have the numbers that the description of a table gives them", "[record]") {
    std::string reported;
    EndingCounts counts;
    for (const Ending ending : all_endings) {
        reported += (reported.empty() ? "" : ", ") + std::to_string(static_cast<int>(ending_code(ending))) +
                    " " + to_string(ending);
        counts.add(ending);
    }
    CHECK(outcome_codes.starts_with(reported));
    CHECK(record_json(counts).dump() ==
          R"({"contact":1,"pursuit":1,"escape":1,"undecided":1,"orbit":1,"bound":1,"failed":0})");
}

// --- What the program knows of scenes and results, and the copy of it that the plots read

TEST_CASE("the plots' schema.json is up to date") {
    std::ifstream in(RODWAKE_SOURCE_DIR "/plots/rodwake_plots/schema.json", std::ios::binary);
    REQUIRE(in.is_open());
    const std::string kept{std::istreambuf_iterator<char>(in), {}};
    INFO("regenerate with: ninja reference");
    const bool up_to_date = kept == app::schema_json();
    CHECK(up_to_date);
}

TEST_CASE("The schema is that of scenes and a line for each value that is measured") {
    const std::string of_scenes = scene::schema_json(), all = app::schema_json();
    const std::string end = "\n}\n";
    CHECK(all.starts_with(of_scenes.substr(0, of_scenes.size() - end.size()) + ",\n \"measures\": [\n"));
    for (const app::MeasureKind& kind : app::measure_kinds())
        for (const ColumnInfo& value : kind.values()) {
            const std::string entry = "\n  {\"measure\":\"" + std::string(kind.name) + "\",\"key\":\"" +
                                      std::string(value.name) + "\",";
            INFO(entry);
            const auto at = all.find(entry);
            REQUIRE(at != std::string::npos);
            const std::string line = all.substr(at, all.find('\n', at + 1) - at);
            CHECK((line.find("\"title\":") == std::string::npos) == value.row.title.empty());
            CHECK((line.find("\"factor\":") == std::string::npos) == value.unit.empty());
        }
}
