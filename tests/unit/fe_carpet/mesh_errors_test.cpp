/// Every mistake of a mesh file is told with its line, its number and what to do.
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/unit/fe_carpet/expect_error.h"
#include "tests/unit/fe_carpet/mesh_samples.h"

namespace tuft::fe::test {
namespace {

/// Expects the sample, with one change, to be refused with these words and the line on which the change
/// begins.
void expect_refused(const std::string& name, const std::string& old_text, const std::string& new_text,
                    std::initializer_list<const char*> words, bool with_line = true) {
  const std::string text = with(sample(name), old_text, new_text);
  SCOPED_TRACE(new_text);
  expect_error<InputError>([&] { (void)import_mesh_text(text, name, sample_options()); }, words);
  if (!with_line) return;
  const std::string place = name + ":" + line_of(text, new_text) + ":";
  expect_error<InputError>([&] { (void)import_mesh_text(text, name, sample_options()); }, {place.c_str()});
}

TEST(MeshErrors, NameTheElementWithAnUnknownNode) {
  expect_refused("tuft_free.k", "1, 1, 1, 2, 5, 4", "1, 1, 1, 2, 55, 4",
                 {"element 1", "node 55", "does not have"});
  expect_refused("tuft.msh", "\n101 5 6 12 11", "\n101 5 6 12 0", {"element 101", "node 0"}, false);
}

TEST(MeshErrors, NameNumbersGivenTwice) {
  expect_refused("tuft_free.k", "22, 10, 1, 5", "21, 10, 1, 5", {"node 21 is there already", "in line 5"},
                 false);
  expect_refused("tuft_free.k", "2, 1, 2, 3, 6, 5", "1, 1, 2, 3, 6, 5", {"element 1 is there already"});
  expect_refused("tuft.msh", "\n2 2 3 6 5", "\n1 2 3 6 5", {"element 1 is there already"}, false);
  expect_refused("tuft.k", "PE fibres\n         2", "PE fibres\n         1", {"part 1 is there already"},
                 false);
  expect_refused("tuft.k", "strand\n        12", "strand\n        11", {"section 11 is there already"},
                 false);
}

TEST(MeshErrors, NameTriangles) {
  expect_refused("tuft_free.k", "1, 1, 1, 2, 5, 4", "1, 1, 1, 2, 5, 5",
                 {"element 1 is a triangle", "mesh the part"});
  expect_refused("tuft_free.k", "1, 1, 1, 2, 5, 4", "1, 1, 1, 2, 5, 0", {"element 1 is a triangle"});
  expect_refused("tuft_free.k", "1, 1, 1, 2, 5, 4", "1, 1, 1, 1, 5, 4", {"element 1 names node 1 twice"});
  expect_refused("tuft_22.msh", "1 3 2 1 5 1 2 5 4", "1 2 2 1 5 1 2 5",
                 {"element 1 ", "a triangle", "recombine"});
  expect_refused("tuft_22.msh", "1 3 2 1 5 1 2 5 4", "1 16 2 1 5 1 2 5 4", {"element 1 ", "second order"});
  expect_refused("tuft_22.msh", "1 3 2 1 5 1 2 5 4", "1 77 2 1 5 1 2 5 4", {"element 1 ", "type 77"});
}

TEST(MeshErrors, NameTheElementWithASideOfNoLength) {
  expect_refused("tuft_free.k", "22, 10, 1, 5", "22, 0, 1, 5",
                 {"element 201", "nodes 22 and 21 are 0 m apart"}, false);
  expect_refused("tuft_free.k", "201 2 5 6 22 21", "201 2 5 6 21 22", {"element 201", "folded"});
}

TEST(MeshErrors, NameTheElementWithoutThickness) {
  MeshImportOptions options = sample_options();
  options.strand_thickness = 0;
  expect_error<InputError>([&] { (void)import_mesh(sample_path("tuft.msh"), options); },
                           {"tuft.msh:69", "element 101", "physical surface 2", "no thickness"});
  expect_refused("tuft_22.msh", "201 0.2", "201 -0.2", {"element 201", "-0.0002 m thick", "positive"}, false);
  expect_refused("tuft.k", "       0.1       0.1", "      -0.1      -0.1",
                 {"section 12 is negative", "'-0.1'"}, false);
}

TEST(MeshErrors, NameNumbersThatAreNone) {
  expect_refused("tuft_free.k", "24, 10, 2, 9", "24, ten, 2, 9", {"x must be a number", "'ten'"});
  expect_refused("tuft_free.k", "24, 10, 2, 9", "24, nan, 2, 9", {"x must be a number", "'nan'"});
  expect_refused("tuft_free.k", "24, 10, 2, 9", "24, &width, 2, 9", {"'&width'", "parameters"});
  expect_refused("tuft_free.k", "24, 10, 2, 9", "24, 10, 2", {"z is missing"});
  expect_refused("tuft_free.k", "24, 10, 2, 9", "0, 10, 2, 9", {"from 1 on", "'0'"});
  expect_refused("tuft_free.k", "24, 10, 2, 9", "99999999999999999999, 10, 2, 9", {"from 1 on"});
  expect_refused("tuft_free.k", "24, 10, 2, 9", "24, 1e9, 2, 9", {"node 24", "a kilometre away", "mesh_unit"},
                 false);
  expect_refused("tuft_22.msh", "24 10 2 9", "24 10 2 9e999", {"z must be a finite number", "'9e999'"});
}

TEST(MeshErrors, SayThatAFileIsCutShort) {
  expect_refused("tuft_free.k", "*end\nnothing after the end is read\n", "", {"without *END", "cut short"},
                 false);
  const std::string text = sample("tuft.msh");
  expect_error<InputError>(
      [&] {
        (void)import_mesh_text(text.substr(0, text.find("$EndElements")), "tuft.msh", sample_options());
      },
      {"tuft.msh:73", "the file ends", "cut short"});
  expect_error<InputError>(
      [&] { (void)import_mesh_text(text.substr(0, text.find("$Elements")), "tuft.msh", sample_options()); },
      {"without $Elements", "cut short"});
}

TEST(MeshErrors, RefuseFormatsOfGmshThatAreNotRead) {
  expect_refused("tuft.msh", "4.1 0 8", "4.1 1 8", {"binary", "Mesh.Binary = 0"});
  expect_refused("tuft.msh", "4.1 0 8", "4 0 8", {"4.1 and 2.2", "'4'", "Mesh.MshFileVersion"});
  expect_refused("tuft.msh", "$MeshFormat", "$Format", {"begins with $MeshFormat"});
  expect_refused("tuft.msh", "$EndNodes", "$PartitionedEntities", {"$EndNodes is needed"});
  expect_refused("tuft.msh", "2 17 1 24", "2 18 1 24", {"another number of nodes"}, false);
}

TEST(MeshErrors, RefuseCardsOfAnotherWidthAndOtherShells) {
  expect_refused("tuft.k", "*KEYWORD", "*KEYWORD LONG=Y", {"another width", "LONG=S"});
  expect_refused("tuft.k", "*NODE", "*NODE +", {"another width"});
  expect_refused("tuft.k", "*ELEMENT_SHELL", "*ELEMENT_SHELL_COMPOSITE",
                 {"not known", "*ELEMENT_SHELL_THICKNESS"});
  expect_refused("tuft_free.k", "1, 1, 1, 2, 5, 4", "1, 1, 1, 2, 5, 4, 7",
                 {"element 1 has nodes on its sides"});
  expect_refused("tuft_free.k", "*keyword", "hello", {"a keyword", "'hello'"});
}

TEST(MeshErrors, NameTheStrandThatHangsOnNothing) {
  expect_refused("tuft_free.k", "201 2 5 6 22 21", "201 2 31 32 22 21\n*node\n31 0 0.5 1\n32 10 0.5 1",
                 {"shares no node with the backing", "merge"});
}

TEST(MeshErrors, SayWhenNothingIsBacking) {
  expect_refused("tuft_free.k", "\nbacking\n", "\nfibre\n", {"no shell of it is backing", "part 1 \"fibre\""},
                 false);
  expect_error<InputError>([] { (void)import_mesh_text("*KEYWORD\n*END\n", "a.k", {}); },
                           {"it has no shells"});
}

TEST(MeshErrors, NameTheEndingThatNoReaderKnows) {
  expect_error<InputError>([] { (void)import_mesh_text("", "carpet.stl", {}); },
                           {"carpet.stl", "'.stl'", ".msh"});
}

}  // namespace
}  // namespace tuft::fe::test
