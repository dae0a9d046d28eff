// Files of tracks: what programs for films write is read, and what is wrong is reported with its place.

#include "rodwake/store/track_file.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "scratch.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>

using namespace rodwake;
using namespace store_test;

namespace {

bool go_on(double) { return true; }

TrackRows read(const std::string& text, const store::TrackColumns& columns = {},
               const std::string& name = "t.csv") {
    const Scratch scratch;
    return store::read_track_csv(scratch.file(name, text), columns, go_on);
}

/// The error's text from the file's name on.
std::string error(const std::string& text, const store::TrackColumns& columns = {},
                  const std::string& name = "t.csv") {
    const std::string what = error_of<InputError>([&] { read(text, columns, name); });
    const auto at = what.find(name);
    return at == std::string::npos ? what : what.substr(at);
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// Three rows, the same whatever the file looks like.
void check_three(const TrackRows& rows) {
    CHECK(rows.frame == std::vector<std::int64_t>{0, 0, 1});
    CHECK(rows.id == std::vector<std::int64_t>{7, 8, 7});
    CHECK(rows.x == std::vector<double>{1.5, 2.0, 1.25});
    CHECK(rows.y == std::vector<double>{-0.5, 3.0, 4e-3});
}

std::string zipped(const std::string& text) {
    const Scratch scratch;
    const gzFile file = ::gzopen((scratch / "z").c_str(), "wb");
    ::gzwrite(file, text.data(), static_cast<unsigned>(text.size()));
    ::gzclose(file);
    return content(scratch / "z");
}

} // namespace

TEST_CASE("Tracks of trackpy and pandas, whatever the separator, the index and the order of columns") {
    for (const std::string text :
         {"frame,particle,x,y\n0,7,1.5,-0.5\n0,8,2,3\n1,7,1.25,4e-3\n",
          "\xEF\xBB\xBF;y;x;mass;particle;frame\r\n0;-0.5;1.5;9;7.0;0.0\r\n1;3;2;;8.0;0\r\n2;4e-3;1.25;a "
          "b;7;1\r\n",
          "# a comment\nX\tY\tFrame\tTRACK_ID\n1.5\t-0.5\t0\t7\n\n2\t3\t0\t8\n1.25\t0.004\t1\t7",
          "\"x\",\"note\",\"y\",\"frame\",\"particle\"\n1.5,\"a,b\",-0.5,0,\"7\"\n2,c,3,0,8\n1.25,\"\",4e-3,"
          "1,7\n",
          "frame,particle,x,y\r0,7,1.5,-0.5\r0,8,+2,3\r1,7,1.25,4e-3\r",
          " % it's 5\" wide, \"no end\nframe,particle,x,y,note\n\t# \"\n0,7,1.5,-0.5,5\"\n%\n0,8,2,3,a "
          "\"b\"\n,,,,"
          "\n1,7,1.25,4e-3,\"\"\"q\"\" \" x\n",
          "frame,\"note, \"\"a\"\"\r\nb\",particle,x,y\r\n0,\"two\r\n\r\nlines, "
          "\"\"7\"\"\",7,1.5,-0.5\r\n0,\"\n#\",8,2,"
          "3\r\n1,,7,1.25,4e-3",
          "\"frame\",\"particle\",\"x\",\"y\"\n\"1\",0,7,1.5,-0.5\n\"2\",0,8,2,3\n\"3\",1,7,1.25,4e-3\n",
          "frame,particle,x,y\n0,7,1.5,-0.5,\n0,8,2,3,,\n1,7,1.25,4e-3\n"}) {
        INFO(text);
        check_three(read(text));
        check_three(read(zipped(text)));
    }
    CHECK(contains(read("x,y,frame\na,1,2,3\n").warnings.at(0), "the first field is passed over"));
    CHECK_THROWS_AS(check_three(read("frame,x,y\n0,1,2\nno,1,2\n")), InputError); // the check can fail
}

TEST_CASE("TrackMate's CSV has three more header lines") {
    const std::string head =
        "LABEL,ID,TRACK_ID,QUALITY,POSITION_X,POSITION_Y,POSITION_T,FRAME\n"
        "Label,Spot ID,Track ID,Quality,X,Y,T,Frame\nLabel,Spot ID,Track ID,Quality,X,Y,T,Frame\n"
        ",,,(quality),(micron),(micron),(sec),\n";
    check_three(read(head + "ID1,1,7,1,1.5,-0.5,0,0\nID2,2,8,1,2,3,0,0\nID3,3,7,1,1.25,0.004,1,1\n"));
    CHECK(contains(error(head + head), "t.csv:5: POSITION_X = \"POSITION_X\": expected a number"));
}

TEST_CASE("Places that are none are counted, spots of no track are kept") {
    const TrackRows rows = read("frame,particle,x,y,theta\n0,1,nan,2,1\n0,2,,2,1\n0,,1,2,<NA>\n0,<NA>,3,4,"
                                "NA\n1,None,inf,1,\n1,1,5,6,NaN\n"
                                "1,<NA>,<NA>,NA,-nan\n");
    CHECK(rows.size() == 3);
    CHECK(rows.without_place == 4);
    CHECK(std::ranges::all_of(rows.heading, [](double angle) { return std::isnan(angle); }));
    CHECK(contains(rows.first_without_place, "t.csv:2"));
    CHECK(rows.id == std::vector<std::int64_t>{no_track, no_track, 1});
    CHECK(read("frame,x,y\n0,1,2\n").id == std::vector<std::int64_t>{no_track});
}

TEST_CASE("Columns by name: times, headings and kinds") {
    store::TrackColumns columns;
    columns.time = "t (s)";
    columns.x = "px";
    columns.heading = "phi";
    const TrackRows rows = read("t (s),id,px,y,phi,kind\n0.02,3,1,2,0.5,rod\n0.04,3,1,2,,bead\n", columns);
    CHECK(rows.frame.empty());
    CHECK(rows.time == std::vector<double>{0.02, 0.04});
    CHECK(rows.heading[0] == 0.5);
    CHECK(std::isnan(rows.heading[1]));
    CHECK(rows.is_rod == std::vector<std::uint8_t>{1, 0});
}

TEST_CASE("Rows written as plain CSV read back to the bit") {
    TrackRows rows;
    rows.frame = {0, -3};
    rows.id = {no_track, 7};
    rows.x = {0.1, 1e300};
    rows.y = {-1.0 / 3.0, 5e-324};
    const Scratch scratch;
    store::TrackColumns columns;
    const auto written = [&] {
        store::write_plain_csv(rows, scratch / "t.csv");
        return store::read_track_csv(scratch / "t.csv", columns, go_on);
    };
    const TrackRows plain = written();
    CHECK((plain.frame == rows.frame && plain.id == rows.id && plain.x == rows.x && plain.y == rows.y));
    CHECK((plain.heading.empty() && plain.is_rod.empty()));
    rows.time = {0.02, 0.1 + 0.2};
    columns.time = "t";
    rows.heading = {std::nan(""), 0.7};
    rows.is_rod = {0, 1};
    const TrackRows all = written();
    CHECK((all.frame.empty() && all.time == rows.time && all.is_rod == rows.is_rod));
    CHECK((std::isnan(all.heading[0]) && all.heading[1] == 0.7));
    rows.x.resize(1);
    CHECK_FALSE(written().x == all.x); // the check can fail
}

TEST_CASE("Ends of rods are guessed where nothing else tells the place") {
    const std::string row = "0,1,4,2,2,2,0.5,7\n";
    const TrackRows rows = read("frame,id,X1,Y1,X2,y2,a,b\n" + row);
    CHECK((rows.x == std::vector<double>{3.0} && rows.y == std::vector<double>{2.0} &&
           rows.length == std::vector<double>{2.0}));
    CHECK(rows.heading == std::vector<double>{0.0}); // the thin end is the first
    CHECK(rows.warnings == std::vector<std::string>{
                               "columns X1, Y1, X2, y2 are taken for the ends of a rod, the thin end first"});
    CHECK(contains(error("frame,id,x1,y1,x2,y2,x,b\n" + row), "no column for y"));
    CHECK(contains(error("frame,id,x1,y1,x2,b,c,d\n" + row), "no column for x"));
    CHECK(read("frame,id,x,y,x1,y1,x2,y2\n" + row).heading.empty());
}

TEST_CASE("Compressed files that are damaged, cut or large are refused, and nothing else") {
    std::string text = "frame,particle,x,y\n";
    for (int row = 0; row < 20000; ++row)
        text += fmt::format("{},{},{},1\n", row, row * 7919 % 10007, 1.0 / (row + 1));
    const std::string whole = zipped(text);
    CHECK(read(whole, {}, "t.csv.gz").size() == 20000);
    double last = 0.0;
    const Scratch scratch;
    store::read_track_csv(scratch.file("t.gz", whole), {}, [&](double part) {
        last = part;
        return true;
    });
    CHECK((last > 0.0 && last <= 1.0));
    for (const std::size_t size : {std::size_t{5}, whole.size() / 2, whole.size() - 1})
        CHECK(contains(error(whole.substr(0, size)), "t.csv: ends within its gzip data"));
    std::string damaged = whole;
    damaged[whole.size() / 2] ^= 0x40;
    CHECK(contains(error(damaged), "t.csv: its gzip data are damaged"));
    store::TrackColumns few;
    few.most_rows = 19999;
    CHECK(
        contains(error(whole, few), "t.csv:20001: more than 19999 rows, and 0.00082 GB of memory for them"));
    CHECK(contains(error(zipped(std::string(std::size_t{1} << 25, '0'))),
                   "t.csv:1: a line of more than 16 MB"));
    CHECK(contains(error("frame,x,y\n0,1,\"2" + std::string(std::size_t{1} << 25, '\n')),
                   "t.csv:2: a quoted cell of more than 16 MB"));
}

TEST_CASE("What is wrong in a file of tracks is reported with line, column and remedy") {
    const std::string head = "frame,particle,x,y\n";
    store::TrackColumns named;
    named.id = "trajectory";
    const struct {
        std::string text, said;
        store::TrackColumns columns = {};
    } cases[] = {
        {"", "t.csv: is empty; expected a header line such as frame,particle,x,y"},
        {"# only\n", "t.csv: is empty"},
        {"0,1,2,3\n", "t.csv:1: the first line holds numbers and no names; put a line such as"},
        {"frame,particle,a,y\n0,1,2,3\n",
         "t.csv:1: no column for x (usual: x); the file has frame, particle, a, "
         "y; name it in tracks.columns = { x = \"...\" }"},
        {"t,particle,x,y\n0,1,2,3\n", "name it in tracks.columns = { frame = \"...\" }, or the times in "
                                      "tracks.time_column"},
        {head, "t.csv: has no row with a position"},
        {head + "0,1,2,3\n", "t.csv:1: no column \"trajectory\"", named},
        {"frame,x,x,y\n0,1,2,3\n", "t.csv:1: column \"x\" appears twice in the header"},
        {head + "0,1,2\n",
         "t.csv:2: has 3 fields, and column \"y\" would be number 4: is the line cut short?"},
        {head + "0,1,2,3\n0,1,abc,3\n", "t.csv:3: x = \"abc\": expected a number"},
        {head + "0.5,1,2,3\n", "t.csv:2: frame = \"0.5\": expected a whole number; name a column of times in "
                               "tracks.time_column"},
        {head + "0,p1,2,3\n", "t.csv:2: particle = \"p1\": expected a whole number; number the particles"},
        {head + ",1,2,3\n", "t.csv:2: frame = \"\": expected a whole number"},
        {"frame;particle;x;y\n0;1;2,5;3\n", "t.csv:2: x = \"2,5\": expected a number; write it as 2.5"},
        {"frame,particle,x,y,kind\n0,1,2,3,fish\n", "t.csv:2: kind = \"fish\": expected bead or rod, 0 or 1"},
        {head + "99999999999999999999,1,2,3\n", "expected a whole number"},
        {head + "0,1,\"2\",\"3\n1,1,2,3\n", "t.csv:2:9: a quote is opened and not closed"},
        {head + "0,1,\"1\"2,3\n", "t.csv:2: x = \"\"1\"2\": expected a number"},
        {head + "0,\"1\n\",2,3\n1,1,2,z\n", "t.csv:2: particle = \"1\\x0a\": expected a whole number"},
        {head + "0,1,2,3\n0,1,2,3,4\n",
         "t.csv:3: has 5 fields, and the header 4: text with \",\" belongs in quotes"},
        {head + "0,1,2,3,,6\n", "t.csv:2: has 6 fields, and the header 4"},
        {head + "7,0,1,2,3\n0,1,2,3\n", "t.csv:3: has 4 fields, and the rows before it 5"},
        {std::string("\xFF\xFE"
                     "f\0,\0y\0",
                     8),
         "t.csv: this is UTF-16, text of two bytes a character: save it"},
        {std::string("\0x\0,\0y\0\n\0"
                     "1",
                     10),
         "t.csv: this is UTF-16"},
        {std::string("frame,x,y\0\n0,1,2\n", 16), "t.csv: this is binary, no text"},
        {"frame,Gr\xF6\xDF"
         "e,y\n0,1,2\n",
         "the file has frame, Gr\\xf6\\xdfe, y (not in UTF-8: save it so)"}};
    for (const auto& one : cases) {
        INFO(one.text);
        const std::string reported = error(one.text, one.columns);
        CAPTURE(reported);
        CHECK(contains(reported, one.said));
    }
}
