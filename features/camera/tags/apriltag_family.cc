// SPDX-License-Identifier: Apache-2.0
#include "features/camera/tags/apriltag_family.h"

extern "C" {
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagCircle49h12.h>
#include <apriltag/tagCustom48h12.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>
}

#include <array>

namespace sextant {
namespace {

struct FamilyEntry {
  const char* name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

#define SEXTANT_FAMILY(name) \
  FamilyEntry { #name, name##_create, name##_destroy }
constexpr std::array kFamilies = {
    SEXTANT_FAMILY(tag36h11),         SEXTANT_FAMILY(tag36h10),
    SEXTANT_FAMILY(tag25h9),          SEXTANT_FAMILY(tag16h5),
    SEXTANT_FAMILY(tagCircle21h7),    SEXTANT_FAMILY(tagCircle49h12),
    SEXTANT_FAMILY(tagCustom48h12),   SEXTANT_FAMILY(tagStandard41h12),
    SEXTANT_FAMILY(tagStandard52h13),
};
#undef SEXTANT_FAMILY

// `Id` is int in AprilTag 3.2 and unsigned in 3.4.
template <class Id>
image_u8_t* Draw(image_u8_t* (*draw)(apriltag_family_t*, Id), apriltag_family_t& family, int id) {
  return draw(&family, static_cast<Id>(id));
}

}  // namespace

const std::vector<std::string>& AprilTagFamilyNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const FamilyEntry& entry : kFamilies) list.emplace_back(entry.name);
    return list;
  }();
  return names;
}

AprilTagFamily MakeAprilTagFamily(std::string_view name) {
  for (const FamilyEntry& entry : kFamilies) {
    if (name == entry.name) return {entry.create(), entry.destroy};
  }
  return {nullptr, [](apriltag_family_t*) {}};
}

AprilTagImage DrawAprilTag(apriltag_family_t& family, int id) {
  return {Draw(apriltag_to_image, family, id), image_u8_destroy};
}

}  // namespace sextant
