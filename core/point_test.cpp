#include "core/point_test.h"

#include <algorithm>

#include "core/error.h"
#include "core/material_reader.h"
#include "core/scene_layout.h"
#include "core/scene_overrides.h"
#include "core/scene_schema.h"

namespace tuft {
namespace schema {
namespace {

constexpr std::string_view path_kinds[] = {"isotropic",  "oedometric",   "triaxial",         "simple_shear",
                                           "pure_shear", "direct_shear", "velocity_gradient"};
constexpr std::string_view measure_kinds[] = {"modulus", "loss", "unloading_over_loading", "friction_angle",
                                              "cohesion"};

void describe_segment(KeyVisitor& keys, PathSegment& segment) {
  keys.enumeration(
      {"path",
       "isotropic; oedometric: along z alone; triaxial: along z under kept stresses x and y; "
       "simple_shear: with its rotation; pure_shear: without; direct_shear: x against z under kept "
       "stress along z; velocity_gradient: as given"},
      segment.kind, path_kinds);
  keys.optional_number(
      {"strain",
       "ends at this change of strain: of volume (isotropic), along z, or of shear; compression "
       "positive"},
      segment.strain, any);
  keys.optional_quantity(
      {"stress", "ends at this stress: pressure (isotropic), along z, or shear; compression positive"},
      segment.stress, "Pa", any);
  keys.optional_quantity({"duration", "velocity_gradient: ends after it"}, segment.duration, "s", positive);
  keys.quantity({"rate", "of that strain; matters to effects that depend on rate or time"}, segment.rate,
                "Hz", positive);
  if (keys.wants({"velocity_gradient", ""}, !segment.velocity_gradient.empty()))
    keys.quantity_list({"velocity_gradient",
                        "velocity_gradient: dv_x/dx, dv_x/dy, ... by rows, extension "
                        "positive"},
                       segment.velocity_gradient, "Hz", any);
  keys.flag({"fresh", "begins with a fresh point, as the test did"}, segment.fresh);
}

void describe_measure(KeyVisitor& keys, PointMeasure& measure) {
  keys.text(required("name", "of the result"), measure.name);
  keys.enumeration(
      {"kind",
       "modulus: secant of an oedometric segment; loss: share of its work that release does not give back; "
       "unloading_over_loading: of their moduli between 10 % and 90 % of the largest stress; friction_angle, "
       "cohesion: of the line through the ends of all direct_shear segments"},
      measure.kind, measure_kinds);
  keys.integer({"segment", "the segment, from 1; not of a line"}, measure.segment,
               {0, unbounded, false, false});
  keys.integer({"release", "loss, unloading_over_loading: the segment that releases it"}, measure.release,
               {0, unbounded, false, false});
  if (keys.wants({"between", ""}, !measure.between.empty()))
    keys.quantity_list({"between", "modulus: two stresses along z"}, measure.between, "Pa", non_negative);
}

}  // namespace

void describe_point_test(KeyVisitor& keys, PointTest& test) {
  keys.table({"point", "what is tested, and how"}, [&](KeyVisitor& inside) {
    inside.text({"name", "a name for reports; left out: the file's"}, test.name);
    inside.material(required("material", "a file of materials/, or a table [materials.NAME]"), test.material);
    inside.number({"residual_compression",
                   "strain of volume that the point keeps of being pressed and released before the test"},
                  test.residual_compression, {0, 1.5, false, false});
    inside.number({"step", "largest strain of a step"}, test.step, {0, 0.01, true, false});
    inside.number({"strain_limit", "a stress that is not met within this strain ends the test with an error"},
                  test.strain_limit, {0, 100, true, false});
    inside.integer({"samples", "rows kept of a segment"}, test.samples, {2, 1e6, false, false});
  });
  keys.table({"effects", "true, false, or \"auto\": on where the material needs it"},
             [&](KeyVisitor& inside) {
               for (const std::string_view name : point_effect_names) {
                 Switch& choice =
                     test.effects.choice.try_emplace(std::string(name), Switch::automatic).first->second;
                 inside.toggle({name, "as in a scene"}, choice);
               }
             });
  keys.list<PathSegment>(required("segments", "the path, in order"), test.segments, describe_segment);
  keys.list<PointMeasure>({"measures", "results of names of one's own"}, test.measures, describe_measure);
}

}  // namespace schema

namespace {

/// The scene that asks of its effects what the test does.
Scene scene_of(const PointTest& test) {
  Scene scene;
  scene.materials = test.materials;
  scene.turf.layers = {{test.material, 1}};
  scene.infill.approach = Approach::sph;
  scene.effects = test.effects;
  return scene;
}

void check_segment(const PathSegment& segment, const std::string& path, const Places& places) {
  const int ends =
      int{segment.strain.has_value()} + int{segment.stress.has_value()} + int{segment.duration.has_value()};
  if (segment.kind == PathKind::velocity_gradient) {
    if (!segment.duration || ends != 1)
      places.fail(path, "a velocity_gradient ends after a duration, and has neither strain nor stress");
    if (segment.velocity_gradient.size() != 9)
      places.fail(path + ".velocity_gradient", fmt::format("nine rates are needed, by rows; there are {}",
                                                           segment.velocity_gradient.size()));
    return;
  }
  if (segment.duration)
    places.fail(path + ".duration", "is for path = \"velocity_gradient\"; give strain or stress");
  if (!segment.velocity_gradient.empty())
    places.fail(path + ".velocity_gradient", "is for path = \"velocity_gradient\"; leave it out");
  if (ends != 1) places.fail(path, "give one of strain and stress: where the segment ends");
  if (segment.strain && *segment.strain == 0) places.fail(path + ".strain", "must not be 0");
}

/// A segment that a measure names: there, and oedometric.
void check_named_segment(const PointTest& test, int number, const std::string& path, const Places& places) {
  if (number < 1 || number > static_cast<int>(test.segments.size()))
    places.fail(path, fmt::format("names a segment, from 1 to {}", test.segments.size()));
  if (test.segments[static_cast<std::size_t>(number - 1)].kind != PathKind::oedometric)
    places.fail(path, fmt::format("segment {} is not oedometric, which is what this measures", number));
}

void check_measure(const PointTest& test, std::size_t index, const Places& places) {
  const PointMeasure& measure = test.measures[index];
  const std::string path = fmt::format("measures.{}", index);
  for (std::size_t i = 0; i < index; ++i)
    if (test.measures[i].name == measure.name) places.fail(path + ".name", "given twice; choose another");
  if (measure.name.empty()) places.fail(path + ".name", "is empty");
  static constexpr std::string_view taken[] = {"largest_pressure", "largest_q", "work", "dissipated"};
  if (measure.name.starts_with("segment_") || std::ranges::find(taken, measure.name) != std::end(taken))
    places.fail(path + ".name", "is the name of a result that every test has; choose another");
  const bool of_line = measure.kind == MeasureKind::friction_angle || measure.kind == MeasureKind::cohesion;
  const bool of_modulus = measure.kind == MeasureKind::modulus;
  if (of_line) {
    const auto sheared =
        std::count_if(test.segments.begin(), test.segments.end(),
                      [](const PathSegment& segment) { return segment.kind == PathKind::direct_shear; });
    if (sheared < 2)
      places.fail(path + ".kind",
                  fmt::format("needs two direct_shear segments or more; the test has {}", sheared));
  } else {
    check_named_segment(test, measure.segment, path + ".segment", places);
  }
  if (!of_line && !of_modulus) {
    check_named_segment(test, measure.release, path + ".release", places);
    if (measure.release != measure.segment + 1)
      places.fail(path + ".release", "must be the segment that follows the one it releases");
  }
  if (of_line && measure.segment != 0)
    places.fail(path + ".segment", "is not for a line, which takes all direct_shear segments; leave it out");
  if ((of_line || of_modulus) && measure.release != 0)
    places.fail(path + ".release", "is for loss and unloading_over_loading; leave it out");
  if (of_modulus && (measure.between.size() != 2 || !(measure.between[0] < measure.between[1])))
    places.fail(path + ".between", "two stresses are needed, the smaller first: [\"100 kPa\", \"600 kPa\"]");
  if (!of_modulus && !measure.between.empty()) places.fail(path + ".between", "is for modulus; leave it out");
}

void check_point_test(const PointTest& test, const Places& places) {
  if (!test.tested().continuum)
    places.fail("point.material",
                fmt::format("has no [continuum] in {}, which is what a point tests", test.tested().file));
  for (std::size_t i = 0; i < test.segments.size(); ++i)
    check_segment(test.segments[i], fmt::format("segments.{}", i), places);
  for (std::size_t i = 0; i < test.measures.size(); ++i) check_measure(test, i, places);
  if (const auto idle = idle_effect(scene_of(test))) places.fail("effects." + idle->name, idle->why);
}

}  // namespace

bool is_point_test(const std::filesystem::path& file) {
  return schema::parse_toml(read_text_file(file), file.string()).contains("point");
}

PointTest read_point_test(const std::filesystem::path& file, const Overrides& overrides,
                          const MaterialTexts& texts) {
  PointTest test;
  test.file = file.string();
  toml::table input = schema::parse_toml(read_text_file(file), test.file);
  Places places;
  MaterialReader materials(test.file, input, places, test.materials);
  schema::Document document = materials.document_for(test.file);
  document.of_scene = false;
  document.overridden = apply_overrides(input, overrides);
  materials.set_overridden(document.overridden);
  materials.set_texts(texts);
  schema::TomlReader::read(document, input, "", "", true, [&](schema::KeyVisitor& keys) {
    dynamic_cast<schema::TomlReader&>(keys).know(materials_key);
    schema::describe_point_test(keys, test);
  });
  materials.read_unused();
  if (test.name.empty()) test.name = file.stem().string();
  check_point_test(test, places);
  return test;
}

std::vector<EffectDecision> decide_effects(const PointTest& test) {
  std::vector<EffectDecision> decisions = decide_effects(scene_of(test));
  std::erase_if(decisions, [](const EffectDecision& decision) {
    return std::find(point_effect_names.begin(), point_effect_names.end(), decision.name) ==
           point_effect_names.end();
  });
  return decisions;
}

}  // namespace tuft
