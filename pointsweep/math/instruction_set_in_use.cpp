// SPDX-License-Identifier: MIT
#include "pointsweep/math/instruction_set_in_use.h"

#include "pointsweep/math/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pointsweep/math/instruction_set_in_use.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <hwy/targets.h>

HWY_BEFORE_NAMESPACE();
namespace pointsweep::HWY_NAMESPACE {

const char* NameOfTarget() { return hwy::TargetName(HWY_TARGET); }

}  // namespace pointsweep::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pointsweep {

HWY_EXPORT(NameOfTarget);

std::string_view instruction_set_in_use() { return HWY_DYNAMIC_DISPATCH(NameOfTarget)(); }

}  // namespace pointsweep
#endif
