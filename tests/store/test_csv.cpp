// Tables: what is written reads back to the bit, and what is wrong is reported with its place.

#include "rodwake/store/csv.hpp"

#include "rodwake/core/error.hpp"
#include "scratch.hpp"

#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <limits>

using namespace rodwake;
using namespace store_test;

namespace {

using Names = std::vector<std::string>;

store::Table read(const std::string& text, const Names& required = {"x", "y"}, const Names& optional = {}) {
    const Scratch scratch;
    return store::read_csv(scratch.file("t.csv", text), required, optional);
}

/// The error's text from the file's name on.
std::string error(const std::string& text, const Names& required = {"x", "y"}, const Names& optional = {}) {
    const std::string what = error_of<InputError>([&] { read(text, required, optional); });
    const auto name = what.find("t.csv:");
    return name == std::string::npos ? what : what.substr(name);
}

} // namespace

TEST_CASE("A round trip keeps every bit") {
    using Limits = std::numeric_limits<double>;
    const std::vector<double> values = {
        0.1,           -1.0 / 3.0,           1e300,         -0.0,
        Limits::min(), Limits::denorm_min(), Limits::max(), std::nextafter(1.0, 2.0)};
    const Names names = {"x", "y"};
    const std::vector<std::vector<double>> columns = {values, {values.rbegin(), values.rend()}};
    const store::Table table = read(store::to_csv(names, columns));
    CHECK(table.names == names);
    REQUIRE(table.rows() == values.size());
    for (std::size_t c = 0; c < 2; ++c)
        for (std::size_t i = 0; i < values.size(); ++i)
            CHECK(std::bit_cast<std::uint64_t>(table.columns[c][i]) ==
                  std::bit_cast<std::uint64_t>(columns[c][i]));
}

TEST_CASE("The text that is written") {
    const Names names = {"t", "x0"};
    const std::vector<std::vector<double>> columns = {{0.0, 0.25}, {1.0, -1e-7}};
    CHECK(store::to_csv(names, columns) == "t,x0\n0,1\n0.25,-9.9999999999999995e-08\n");
    CHECK(store::to_csv(names, std::vector<std::vector<double>>(2)) == "t,x0\n");
}

TEST_CASE("Columns in any order, comments, blank lines, spaces, CRLF, byte order mark, no last newline") {
    const store::Table table =
        read("\xEF\xBB\xBF# comment\r\n\r\n  # indented, with 1,2,3\r\n y , x\r\n 1e2 ,\t-.5\r\n#\n+3,4E-1");
    CHECK(table.names == Names{"y", "x"});
    CHECK(*table.find("x") == std::vector<double>{-0.5, 0.4});
    CHECK(*table.find("y") == std::vector<double>{100.0, 3.0});
    CHECK(table.lines == std::vector<std::size_t>{5, 7});
    CHECK(table.find("z") == nullptr);
}

TEST_CASE("NaN is written as an empty field and read as one") {
    const std::vector<std::vector<double>> columns = {{1.0, 2.0}, {std::nan(""), 3.0}};
    const std::string text = store::to_csv(Names{"x", "sigma"}, columns);
    CHECK(text == "x,sigma\n1,\n2,3\n");
    const store::Table table = read(text, {"x"}, {"sigma"});
    CHECK(std::isnan(table.find("sigma")->at(0)));
    CHECK(table.find("sigma")->at(1) == 3.0);
}

TEST_CASE("Columns that nobody asked for may hold anything") {
    const store::Table table = read("name,x,note,y\nrod one,1,,2\n,3,nan,4\n");
    CHECK(table.names == Names{"x", "y"});
    CHECK(*table.find("x") == std::vector<double>{1.0, 3.0});
    CHECK(*table.find("y") == std::vector<double>{2.0, 4.0});
}

TEST_CASE("Fields may be quoted") {
    const store::Table table =
        read("\"x\", \"y\" ,\"the \"\"name\"\", quoted\"\n\"1\",2,\"a,b\"\n 3 , \"-4e1\" ,\"\"\n");
    CHECK(*table.find("x") == std::vector<double>{1.0, 3.0});
    CHECK(*table.find("y") == std::vector<double>{2.0, -40.0});
    CHECK(read("x,y\n1,2\n\"1\",\"2\"\r\n").rows() == 2);
    CHECK(error("x,y\n1,\"2\n") == "t.csv:2:3: a quote is opened and not closed");
    CHECK(error("x,y\n\"1\"2,2\n") == "t.csv:2:1: x: expected a number, found \"\"1\"2\"");
    const store::Table wrapped = read("x,\"a\nnote\",y\n1,\"two\r\nlines, \"\"3\"\"\",2\n3,5\" lens,4\n");
    CHECK(wrapped.columns == std::vector<std::vector<double>>{{1.0, 3.0}, {2.0, 4.0}});
    CHECK(wrapped.lines == std::vector<std::size_t>{3, 5});
    CHECK(error("x,y\n\"one\",2\n") == "t.csv:2:1: x: expected a number, found \"one\"");
    CHECK(error("\"x\",\"x\"\n") == "t.csv:1:5: column \"x\" appears twice in the header");
}

TEST_CASE("Optional columns may be absent or have gaps, but no nonsense") {
    CHECK(read("x,y\n1,2\n", {"x", "y"}, {"L"}).find("L") == nullptr);
    CHECK(std::isnan(read("L,x,y\n<NA>,1,2\n", {"x", "y"}, {"L"}).find("L")->at(0)));
    const store::Table table = read("L,x,y\n,1,2\n5,1,2\n", {"x", "y"}, {"L"});
    CHECK(std::isnan(table.find("L")->at(0)));
    CHECK(table.find("L")->at(1) == 5.0);
    CHECK(
        has(error("x,y,L\n1,2,big\n", {"x", "y"}, {"L"}), "t.csv:2:5: L: expected a number, found \"big\""));
}

TEST_CASE("What is not a finite number is reported with its place") {
    CHECK(has(error("x,y\n1,2\n3,four\n"), "t.csv:3:3: y: expected a number, found \"four\""));
    CHECK(has(error("# one\nx,y\n1 2,3\n"), "t.csv:3:1: x: expected a number, found \"1 2\""));
    for (const char* wrong : {"", " ", "1.5e", "0x10", "1,5", "--1", "+-1", "1d3", "\"1\"2", "1;2", "nan",
                              "inf", "-inf", "1e400"}) {
        CAPTURE(wrong);
        CHECK(has(error("y,x\n0," + std::string(wrong) + "\n"), "t.csv:2:"));
    }
    CHECK(has(error("x,y\nnan,1\n"), "must be finite"));
    CHECK(has(error("x,y\n1e400,1\n"), "too large or too small"));
}

TEST_CASE("Rows of the wrong length") {
    CHECK(has(error("x,y\n1\n"), "t.csv:2:1: 1 fields, but the header has 2"));
    CHECK(has(error("x,y\n1,2,3\n"), "t.csv:2:5: 3 fields, but the header has 2"));
}

TEST_CASE("Headers that cannot be used") {
    CHECK(has(error("x\n1\n"), "t.csv:1:1: no column \"y\"; the header must have at least x,y"));
    CHECK(has(error("x,y,x\n"), "t.csv:1:5: column \"x\" appears twice"));
    CHECK(has(error("x,,y\n"), "t.csv:1:3: empty column name"));
    CHECK(has(error("X,y,z\n1,2,3\n"), "no column \"x\"; the header must have at least x,y; it has X,y,z"));
    CHECK(has(error("x y\n1 2\n"), "columns are separated by commas, semicolons or tabs"));
    CHECK(has(error("# x,y\n1,1\n2,3\n"), "t.csv:2:1: no header line: here are numbers, not names"));
    CHECK(has(error(""), "no header line; expected at least x,y"));
    CHECK(has(error("# only a comment\n\n"), "no header line"));
    CHECK(read("x,y\n").rows() == 0);
}

TEST_CASE("Tables as other programs write them are the same table") {
    const Names names = {"x", "y"};
    const std::vector<std::vector<double>> columns = {{1.0, 3.0}, {2.5, -4.0}};
    const std::string index = ",x,y\n0,1,2.5\n1,3,-4\n",
                      quoted = "\"\"\t\"x\"\t\"y\"\n0\t1\t\"2.5\"\n\t3\t-4\n";
    for (const std::string& text :
         {index, quoted, "\xEF\xBB\xBF" + index, std::string("x,y,\n1,2.5,\n3,-4\n"),
          std::string("x,y\n1,2.5,,\n3,-4,\n,,\n"),
          std::string("\n \t\n  # note\n% note\nx;y\n1;2.5\n\n3;-4\n;\n"),
          std::string("x\ty\n1\t2.5\n 3 \t -4\n"), std::string("x,y\r1,2.5\r3,-4\r"),
          std::string("x;y;\"a,b,c\"\n1;2.5;\"1,2;3\"\n3;-4;\n"), std::string(",x,y\r\n0,1,2.5\r\n1,3,-4")}) {
        CAPTURE(text);
        CHECK(read(text).columns == columns);
    }
    const Scratch scratch;
    CHECK(store::csv_names(scratch.file("n.csv", "\n  # note\n;\"x\";y;\n0;1;2;\n")) == names);
    CHECK(
        has(error_of<InputError>([&] { store::csv_names(scratch.file("n.csv", "#\n")); }), "no header line"));
    CHECK(read("x,y\r1,2\r\r3,4").lines == std::vector<std::size_t>{2, 4});
}

TEST_CASE("What other programs write and cannot be read says what to do") {
    CHECK(has(error("x;y\n1;2\n3;1,5\n"), "t.csv:3:3: y: expected a number, found \"1,5\"; write it as 1.5"));
    CHECK(has(error("x,y\n1.0D+03,2\n"),
              "t.csv:2:1: x: expected a number, found \"1.0D+03\"; write it as 1.0e+03"));
    CHECK(has(error("x,y\n1,\n"), "t.csv:2:3: y: expected a number, found an empty cell"));
    CHECK(has(error("x,y\nNA,1\n"), "t.csv:2:1: x: expected a number, found \"NA\""));
    CHECK(has(error("x;y\n1;2;3\n"), "t.csv:2:5: 3 fields, but the header has 2"));
    for (const std::string& wide :
         {std::string("\xFF\xFEx\0,\0y\0\n\0", 10), std::string("x\0,\0y\0\n\0", 8)})
        CHECK(has(error_of<InputError>([&] { read(wide); }),
                  "t.csv: this is UTF-16, text of two bytes a character: save"));
    CHECK(has(error(std::string("x,y\n1,\0002\n", 9)), "t.csv:2:3: y: expected a number, found \"\\x002\""));
}

TEST_CASE("Text of the file in a message is cut and harmless") {
    const std::string long_cell = error("x,y\n1," + std::string(59, 'a') + "\xC3\xA9" + "b\n");
    CHECK(
        has(long_cell, "found \"" + std::string(59, 'a') + "...\"")); // the letter of two bytes is not halved
    CHECK(has(error("x,y\n1,\x1b[31m\n"), "found \"\\x1b[31m\""));
    CHECK(has(error("x,\x1b]\n"), "it has x,\\x1b]"));
}

TEST_CASE("Files that cannot be read") {
    const Scratch scratch;
    const auto open = [&](const std::string& name) {
        return error_of<InputError>([&] { store::read_csv(scratch / name, Names{"x"}); });
    };
    CHECK(has(open("none.csv"), (scratch / "none.csv").string() + ": cannot read"));
    CHECK(has(open(""), "is a folder"));
}
