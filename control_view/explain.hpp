#pragma once

#include <span>

#include "control_view/engine.hpp"
#include "control_view/visibility_pipeline.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// Why the object is in the newest set of the view that `pipeline` answers, or is not. `boxed` are the boxes
/// of the newest request, ascending, and `edits` what the session's next answer would be given with.
///
/// The state follows the set that was sent; who hides the object is found by looking again, from the same
/// eyes but with today's edits. In every state but unknown, absent and outside `hidden_by` names them: what
/// is visible may be hidden in part. It is empty where nothing hides the object and it still has no pixel
/// (it faces away, or lies between the samples), and where the engine cannot say.
///
/// Changes nothing but where the engine has its objects, as any answer does. session_id, nonce, view and
/// object_id are copied. Throws what the engine throws.
[[nodiscard]] WhyAnswer explain(const Why& why, const VisibilityPipeline& pipeline,
                                std::span<const BoxedObject> boxed, const SceneEdits& edits,
                                VisibilityEngine& engine);

/// Of the answers about two levels of detail of one thing, the one that speaks for both: the thing is in the
/// set when either is.
[[nodiscard]] WhyAnswer stronger_of(WhyAnswer a, WhyAnswer b);

}  // namespace sightline
