// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The inner parts have enumerations of their own, whose numbers are those of the interface: what
// one passes on the other understands.
#include <type_traits>

#include "integrator/scene/scene_description.h"
#include "integrator/values/notice.h"
#include "plugin/include/pm_plugin.h"
#include "plugin/parameters/parameter.h"
#include "plugin/session/layer_table.h"
#include "plugin/session/render.h"
#include "plugin/session/render_listener.h"
#include "plugin/session/setting_table.h"
#include "plugin/session/stop_rule.h"
#include "plugin/textures/texture_system.h"
#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

template <typename Enumeration, typename Number>
constexpr bool same(Enumeration inner, Number outer) {
    return static_cast<std::int64_t>(inner) == static_cast<std::int64_t>(outer);
}

}  // namespace

static_assert(same(CallStatus::kOk, PMR_OK));
static_assert(same(CallStatus::kInternal, PMR_ERROR_INTERNAL));
static_assert(same(CallStatus::kArgument, PMR_ERROR_ARGUMENT));
static_assert(same(CallStatus::kHandle, PMR_ERROR_HANDLE));
static_assert(same(CallStatus::kState, PMR_ERROR_STATE));
static_assert(same(CallStatus::kScene, PMR_ERROR_SCENE));
static_assert(same(CallStatus::kUnsupported, PMR_ERROR_UNSUPPORTED));
static_assert(same(CallStatus::kMemory, PMR_ERROR_MEMORY));
static_assert(same(CallStatus::kIo, PMR_ERROR_IO));
static_assert(same(CallStatus::kCancelled, PMR_ERROR_CANCELLED));
static_assert(same(CallStatus::kInCallback, PMR_ERROR_IN_CALLBACK));
static_assert(same(CallStatus::kTimeout, PMR_ERROR_TIMEOUT));
static_assert(same(CallStatus::kAbi, PMR_ERROR_ABI));
static_assert(same(CallStatus::kName, PMR_ERROR_NAME));
static_assert(same(CallStatus::kFile, PMR_ERROR_FILE));
static_assert(same(CallStatus::kMismatch, PMR_ERROR_MISMATCH));

static_assert(same(MessageLevel::kDebug, PMR_LEVEL_DEBUG));
static_assert(same(MessageLevel::kInfo, PMR_LEVEL_INFO));
static_assert(same(MessageLevel::kWarning, PMR_LEVEL_WARNING));
static_assert(same(MessageLevel::kError, PMR_LEVEL_ERROR));

static_assert(same(kMessageNone, PMR_MESSAGE_NONE));
static_assert(same(kMessageTexture, PMR_MESSAGE_TEXTURE));
static_assert(same(kMessageCheckpoint, PMR_MESSAGE_CHECKPOINT));
static_assert(same(kMessagePhase, PMR_MESSAGE_PHASE));
static_assert(same(NoticeCode::kNoLight, PMR_MESSAGE_NO_LIGHT));
static_assert(same(NoticeCode::kNoPhotons, PMR_MESSAGE_NO_PHOTONS));
static_assert(same(NoticeCode::kNoCausticPhotons, PMR_MESSAGE_NO_CAUSTIC_PHOTONS));
static_assert(same(NoticeCode::kBadValues, PMR_MESSAGE_BAD_VALUES));
static_assert(same(NoticeCode::kLostPhotons, PMR_MESSAGE_LOST_PHOTONS));
static_assert(same(NoticeCode::kDegenerateGeometry, PMR_MESSAGE_DEGENERATE_GEOMETRY));
static_assert(same(NoticeCode::kTexture, PMR_MESSAGE_TEXTURE));
static_assert(same(NoticeCode::kNotCovered, PMR_MESSAGE_NOT_COVERED));

static_assert(same(StopReason::kNone, PMR_STOP_NONE));
static_assert(same(StopReason::kPasses, PMR_STOP_PASSES));
static_assert(same(StopReason::kErrorTarget, PMR_STOP_ERROR_TARGET));
static_assert(same(StopReason::kTimeLimit, PMR_STOP_TIME_LIMIT));
static_assert(same(StopReason::kCancelled, PMR_STOP_CANCELLED));
static_assert(same(StopReason::kFailed, PMR_STOP_FAILED));

static_assert(same(RenderState::kCreated, PMR_RENDER_CREATED));
static_assert(same(RenderState::kRunning, PMR_RENDER_RUNNING));
static_assert(same(RenderState::kFinished, PMR_RENDER_FINISHED));
static_assert(same(CallbackMode::kThread, PMR_CALLBACKS_THREAD));
static_assert(same(CallbackMode::kPoll, PMR_CALLBACKS_POLL));
static_assert(same(PixelDelivery::kFrame, PMR_DELIVERY_FRAME));
static_assert(same(PixelDelivery::kBuckets, PMR_DELIVERY_BUCKETS));

static_assert(same(SettingType::kInteger, PMR_SETTING_INTEGER));
static_assert(same(SettingType::kNumber, PMR_SETTING_NUMBER));
static_assert(same(SettingType::kChoice, PMR_SETTING_CHOICE));
static_assert(same(SettingType::kText, PMR_SETTING_TEXT));
static_assert(same(LayerKind::kColour, PMR_LAYER_COLOUR));
static_assert(same(LayerKind::kData, PMR_LAYER_DATA));

static_assert(same(ParameterType::kNumber, PMR_PARAMETER_NUMBER));
static_assert(same(ParameterType::kInteger, PMR_PARAMETER_INTEGER));
static_assert(same(ParameterType::kChoice, PMR_PARAMETER_CHOICE));
static_assert(same(ParameterType::kText, PMR_PARAMETER_TEXT));
static_assert(same(ParameterType::kTexture, PMR_PARAMETER_TEXTURE));
static_assert(same(ParameterType::kObjects, PMR_PARAMETER_OBJECTS));
static_assert(same(MaterialKind::kSurface, PMR_MATERIAL_SURFACE));
static_assert(same(MaterialKind::kMirror, PMR_MATERIAL_MIRROR));
static_assert(same(MaterialKind::kDielectric, PMR_MATERIAL_DIELECTRIC));
static_assert(same(MaterialKind::kMixture, PMR_MATERIAL_MIXTURE));

static_assert(same(Wrap::kRepeat, PMR_WRAP_REPEAT));
static_assert(same(Wrap::kClamp, PMR_WRAP_CLAMP));
static_assert(same(Wrap::kMirror, PMR_WRAP_MIRROR));
static_assert(same(Wrap::kBlack, PMR_WRAP_BLACK));

static_assert(same(kCameraRays, PMR_HIDDEN_FROM_CAMERA));
static_assert(same(kShadowRays, PMR_HIDDEN_FROM_SHADOW));
static_assert(same(kReflectionRays, PMR_HIDDEN_FROM_REFLECTION));

}  // namespace pm::plugin
