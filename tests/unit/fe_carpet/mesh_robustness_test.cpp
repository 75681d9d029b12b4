/// No bytes make a reader do anything but give a sound mesh or an InputError of one line.
#include <gtest/gtest.h>

#include <random>

#include "core/error.h"
#include "tests/unit/fe_carpet/mesh_samples.h"

namespace tuft::fe::test {
namespace {

constexpr const char* samples[] = {"tuft.msh", "tuft_22.msh", "tuft.k", "tuft_free.k"};

/// Whether the text was taken; what else than InputError comes out fails the test by itself.
bool taken(const std::string& text, const std::string& name) {
  try {
    const ImportedMesh imported = import_mesh_text(text, name, sample_options());
    check_mesh(imported.mesh);
    EXPECT_EQ(imported.node_ids.size(), imported.mesh.nodes.size());
    return true;
  } catch (const InputError& error) {
    const std::string words = error.what();
    EXPECT_EQ(words.find('\n'), std::string::npos) << words;
    EXPECT_EQ(words.find('\0'), std::string::npos);
    return false;
  }
}

/// A reader that takes everything, or nothing, has not been tried.
struct Outcomes {
  int took = 0, refused = 0;
  void count(bool was_taken) { ++(was_taken ? took : refused); }
  void expect_both(const char* name) const {
    EXPECT_GT(took, 5) << name;
    EXPECT_GT(refused, 5) << name;
  }
};

TEST(MeshRobustness, AFileCutAtAnyLengthIsRefusedOrWhole) {
  for (const char* name : samples) {
    const std::string text = sample(name);
    // What may be cut without harm: the last newline, views after the elements, text after *END.
    const std::size_t essential = std::min({text.find("$EndElements"), text.find("*END"), text.find("*end")});
    for (std::size_t length = 0; length < text.size(); ++length)
      EXPECT_TRUE(!taken(text.substr(0, length), name) || length > essential) << name << " cut at " << length;
  }
}

TEST(MeshRobustness, EveryByteMayBeAnyOther) {
  std::mt19937 random(7);
  const std::string awkward("\0\xff\n\r\t *$,-+.&9e\"", 16);
  for (const char* name : samples) {
    const std::string text = sample(name);
    Outcomes outcomes;
    for (std::size_t at = 0; at < text.size(); ++at) {
      std::string changed = text;
      changed[at] = static_cast<char>(changed[at] ^ (1U << random() % 8));
      outcomes.count(taken(changed, name));
      changed[at] = awkward[random() % awkward.size()];
      outcomes.count(taken(changed, name));
    }
    outcomes.expect_both(name);
  }
}

TEST(MeshRobustness, LinesAndPiecesMayBeLostMovedOrDoubled) {
  std::mt19937 random(11);
  for (const char* name : samples) {
    const std::string text = sample(name);
    Outcomes outcomes;
    for (int i = 0; i < 2000; ++i) {
      std::string changed = text;
      for (int k = 0; k < 1 + i % 3; ++k) {
        const std::size_t from = random() % changed.size();
        const std::string piece = changed.substr(from, random() % 80);
        if (random() % 2 == 0) changed.erase(from, piece.size());
        changed.insert(random() % (changed.size() + 1), piece);
      }
      outcomes.count(taken(changed, name));
    }
    outcomes.expect_both(name);
  }
}

TEST(MeshRobustness, NoiseIsRefused) {
  std::mt19937 random(13);
  for (const char* name : {"noise.msh", "noise.k"})
    for (int i = 0; i < 500; ++i) {
      std::string noise(random() % 400, '\0');
      for (char& letter : noise) letter = static_cast<char>(random());
      EXPECT_FALSE(taken(noise, name));
      (void)taken((i % 2 == 0 ? "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n" : "*KEYWORD\n*NODE\n") + noise,
                  name);
    }
}

TEST(MeshRobustness, CountsBeyondReasonCostNothing) {
  for (const char* count : {"9223372036854775807", "99999999999", "-1", "99999999999999999999999"}) {
    EXPECT_FALSE(taken(with(sample("tuft.msh"), "2 5 1 9", std::string("2 5 1 ") + count), "tuft.msh"));
    EXPECT_FALSE(taken(with(sample("tuft_22.msh"), "$Nodes\n17", std::string("$Nodes\n") + count), "a.msh"));
    EXPECT_FALSE(
        taken(with(sample("tuft_22.msh"), "1\n2\n1 2.5", std::string("1\n") + count + "\n1 2.5"), "a.msh"));
  }
}

}  // namespace
}  // namespace tuft::fe::test
