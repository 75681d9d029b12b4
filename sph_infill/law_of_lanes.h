#pragma once
/// What the update of the soil law (soil_update.h) asks of a law: of one point, and of as many as there are
/// lanes, each with its own.
#include <algorithm>
#include <array>

#include "core/lane_math.h"
#include "sph_infill/soil_law.h"

namespace tuft::sph {

class LawOfPoint {
 public:
  explicit LawOfPoint(const SoilLaw& law) : law_(law) {}
  [[nodiscard]] CurvePiece virgin_piece(double e) const { return law_.virgin.piece(e); }
  [[nodiscard]] CurvePiece elastic_piece(double strain) const { return law_.elastic.piece(strain); }
  [[nodiscard]] CurvePiece elastic_piece_of_value(double p) const { return law_.elastic.piece_of_value(p); }
  [[nodiscard]] double value(double SoilLaw::*parameter) const { return law_.*parameter; }

 private:
  const SoilLaw& law_;
};

/// The same for a law a lane; quicker where all lanes have the same.
class LawOfLanes {
 public:
  explicit LawOfLanes(const std::array<const SoilLaw*, lanes>& law)
      : law_(law), alike_(std::ranges::all_of(law, [&](const SoilLaw* each) { return each == law[0]; })) {}
  [[nodiscard]] CurvePieceOf<Pack> virgin_piece(const Pack& e) const {
    if (alike_) return law_[0]->virgin.piece(e);
    return gather_pieces([&](std::size_t l) -> const CurvePiece& { return law_[l]->virgin.piece(e[l]); });
  }
  [[nodiscard]] CurvePieceOf<Pack> elastic_piece(const Pack& strain) const {
    if (alike_) return law_[0]->elastic.piece(strain);
    return gather_pieces(
        [&](std::size_t l) -> const CurvePiece& { return law_[l]->elastic.piece(strain[l]); });
  }
  [[nodiscard]] CurvePieceOf<Pack> elastic_piece_of_value(const Pack& p) const {
    if (alike_) return law_[0]->elastic.piece_of_value(p);
    return gather_pieces(
        [&](std::size_t l) -> const CurvePiece& { return law_[l]->elastic.piece_of_value(p[l]); });
  }
  [[nodiscard]] Pack value(double SoilLaw::*parameter) const {
    if (alike_) return law_[0]->*parameter;
    return Pack([&](auto lane) { return law_[lane]->*parameter; });
  }

 private:
  template <class PieceOfLane>
  static CurvePieceOf<Pack> gather_pieces(PieceOfLane&& piece_of_lane) {
    std::array<const CurvePiece*, lanes> piece;
    for (std::size_t l = 0; l < lanes; ++l) piece[l] = &piece_of_lane(l);
    return {Pack([&](auto l) { return piece[l]->x0; }), Pack([&](auto l) { return piece[l]->y0; }),
            Pack([&](auto l) { return piece[l]->slope; }), Pack([&](auto l) { return piece[l]->rate; }),
            Pack([&](auto l) { return piece[l]->area0; })};
  }

  const std::array<const SoilLaw*, lanes>& law_;
  bool alike_;
};

}  // namespace tuft::sph
