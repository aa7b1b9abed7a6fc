#include "main_view/app/view_panel.hpp"

#include <imgui/backends/imgui_impl_glfw.h>
#include <imgui/backends/imgui_impl_opengl3.h>
#include <imgui/imgui.h>

#include "common/error.hpp"
#include "common/gl/functions.hpp"

namespace sightline {
namespace {

const ImVec4 k_good{0.45f, 0.85f, 0.50f, 1.0f};
const ImVec4 k_bad{1.0f, 0.62f, 0.35f, 1.0f};
const ImVec4 k_chosen{1.0f, 0.85f, 0.35f, 1.0f};

/// A row of words with the one in force highlighted.
void choice(const char* label, std::initializer_list<const char*> words, int chosen) {
  ImGui::TextUnformatted(label);
  int index = 0;
  for (const char* word : words) {
    ImGui::SameLine();
    if (index++ == chosen) {
      ImGui::TextColored(k_chosen, "%s", word);
    } else {
      ImGui::TextDisabled("%s", word);
    }
  }
}

void frame_section(const ViewStatus& status) {
  ImGui::Text("%6.1f ms to draw, %6.1f ms a frame", status.draw_ms, status.frame_ms);
  const auto share = [](double part, double whole) { return whole > 0.0 ? 100.0 * part / whole : 0.0; };
  ImGui::Text("%9u objects   of %9u  (%.2f %%)", status.drawn.objects, status.object_count,
              share(status.drawn.objects, status.object_count));
  ImGui::Text("%9llu triangles of %9llu  (%.2f %%)", static_cast<unsigned long long>(status.drawn.triangles),
              static_cast<unsigned long long>(status.triangle_count),
              share(double(status.drawn.triangles), double(status.triangle_count)));
  if (status.max_layers) ImGui::Text("%9u layers at most in a pixel", *status.max_layers);
}

void milliseconds(const char* name, const std::optional<double>& seconds) {
  if (seconds) {
    ImGui::Text("%s %6.1f ms", name, 1000.0 * *seconds);
  } else {
    ImGui::TextDisabled("%s      -", name);
  }
}

void service_section(const ViewStatus& status) {
  if (!status.has_service) {
    ImGui::TextDisabled("no daemon: start with --spawn or --connect");
    return;
  }
  ImGui::TextUnformatted(status.service_state.c_str());
  milliseconds("set before now, age  ", status.last_age_s);
  milliseconds("set after now, lead  ", status.next_lead_s);
  milliseconds("round trip           ", status.round_trip_s);
  if (status.culling == CullingMode::service) {
    if (status.fallback.empty()) {
      ImGui::TextColored(k_good, "drawing what the service reports");
    } else {
      ImGui::TextColored(k_bad, "view frustum alone: %s", status.fallback.c_str());
    }
  }
}

void why_section(const ViewStatus& status) {
  // Names in real scenes are long.
  ImGui::PushTextWrapPos(34.0f * ImGui::GetFontSize());
  for (const std::string& line : status.why) ImGui::TextUnformatted(line.c_str());
  ImGui::PopTextWrapPos();
}

void help_section() {
  ImGui::TextUnformatted(
      "W A S D  Q E   fly, down and up; Shift: faster\n"
      "right mouse    hold and look around\n"
      "left mouse     ask why: an object, or a culled one's box while frozen\n"
      "P              follow the path\n"
      "1 2 3 4        none, frustum, service, oracle\n"
      "I  C           item buffer, depth complexity\n"
      "F  B           freeze the culling, look from behind\n"
      "H  Esc         this help, quit");
}

}  // namespace

ViewPanel::ViewPanel(gl::Context& context) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // leaves no file behind
  ImGui::StyleColorsDark();
  ImGui::GetStyle().WindowRounding = 5.0f;
  if (!ImGui_ImplGlfw_InitForOpenGL(context.window(), true) || !ImGui_ImplOpenGL3_Init("#version 450 core")) {
    throw MachineError("ImGui: its OpenGL backend cannot be started");
  }
}

ViewPanel::~ViewPanel() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

void ViewPanel::draw(const ViewStatus& status) {
  gl::glBindFramebuffer(GL_FRAMEBUFFER, 0);
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  ImGui::SetNextWindowPos({12, 12}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowBgAlpha(0.78f);
  ImGui::Begin("Sightline", nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoNav);
  choice("culling", {"1 none", "2 frustum", "3 service", "4 oracle"}, static_cast<int>(status.culling));
  choice("picture", {"shaded", "I item buffer", "C layers"}, static_cast<int>(status.picture));
  choice("camera ", {status.has_path ? "P path" : "no path", "free", "F frozen"},
         status.frozen    ? 2
         : status.playing ? 0
                          : 1);
  ImGui::Separator();
  frame_section(status);
  ImGui::Separator();
  service_section(status);
  if (!status.why.empty()) {
    ImGui::Separator();
    why_section(status);
  }
  if (help_) {
    ImGui::Separator();
    help_section();
  }
  ImGui::End();
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

bool ViewPanel::wants_mouse() const {
  return ImGui::GetIO().WantCaptureMouse;
}
bool ViewPanel::wants_keyboard() const {
  return ImGui::GetIO().WantTextInput;
}

}  // namespace sightline
