// libFuzzer target: bytes as a program that calls the C interface in any order, with any numbers. Pointers
// are null or right, since no library can tell others; everything else is for the bytes to say.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <type_traits>
#include <vector>

#include "main_view/client/c_api/sightline.h"

namespace {

/// Takes values off the front of the input; zeros when it is used up.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}

  [[nodiscard]] bool done() const { return left_ == 0; }

  template <typename Value>
  Value take() {
    static_assert(std::is_trivially_copyable_v<Value>);
    Value value{};
    const std::size_t size = std::min(sizeof value, left_);
    if (size > 0) std::memcpy(&value, data_, size);
    data_ += size;
    left_ -= size;
    return value;
  }
  std::uint32_t below(std::uint32_t limit) { return take<std::uint8_t>() % limit; }
  /// Mostly a number that means something, at times any.
  double number() {
    const std::uint8_t kind = take<std::uint8_t>();
    return kind < 200 ? (kind - 100) * 0.25 : take<double>();
  }
  void matrix(double* into) {
    const std::uint8_t kind = take<std::uint8_t>();
    for (int i = 0; i < 16; ++i) into[i] = i % 5 == 0 ? 1.0 : 0.0;
    if (kind < 64) return;
    if (kind < 128) {
      for (int i = 12; i < 15; ++i) into[i] = number();
    } else if (kind < 192) {
      into[10] = into[11] = -1.0;
      into[14] = -0.2;
      into[15] = 0.0;
    } else {
      for (int i = 0; i < 16; ++i) into[i] = number();
    }
  }
  template <typename Structure>
  Structure structure() {
    Structure made = take<std::uint8_t>() < 8 ? take<Structure>() : Structure{};
    // A size beyond the structure would be a lie about memory, as a wrong pointer is.
    made.struct_size = take<std::uint8_t>() < 250 ? sizeof(Structure) : below(sizeof(Structure) + 1);
    return made;
  }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

constexpr std::size_t k_most = 8;

void add_to_scene(Input& in, sl_scene scene) {
  std::uint32_t id = 0;
  switch (in.below(4)) {
    case 0: {
      const std::array<std::uint8_t, 64> texels{};
      auto material = in.structure<sl_material>();
      material.texture_width = in.below(9);
      material.texture_height = in.below(8);
      material.alpha_texture = in.below(8) != 0 ? texels.data() : nullptr;
      sl_scene_add_material(scene, &material, &id);
      return;
    }
    case 1: {
      std::array<float, 3 * k_most> positions{};
      std::array<std::uint32_t, 12> indices{};
      std::array<sl_part, 3> parts{};
      for (float& value : positions) value = static_cast<float>(in.number());
      for (std::uint32_t& index : indices) index = in.below(9);
      for (sl_part& part : parts) part = {in.below(13), in.below(13), in.below(4)};
      auto mesh = in.structure<sl_mesh>();
      mesh.vertex_count = in.below(k_most + 1);
      mesh.positions = in.below(16) != 0 ? positions.data() : nullptr;
      mesh.position_stride = in.below(13) / 12 * 12;
      mesh.texcoords = in.below(2) != 0 ? positions.data() : nullptr;
      mesh.texcoord_stride = 0;
      mesh.indices = in.below(4) != 0 ? indices.data() : nullptr;
      mesh.index_count = in.below(13);
      mesh.parts = in.below(4) == 0 ? parts.data() : nullptr;
      mesh.part_count = in.below(4);
      sl_scene_add_mesh(scene, &mesh, &id);
      return;
    }
    case 2: {
      auto object = in.structure<sl_object>();
      object.mesh = in.below(4);
      object.flags = in.below(80);
      in.matrix(object.world_from_object);
      sl_scene_add_object(scene, &object, nullptr);
      return;
    }
    default:
      sl_scene_set_spares(scene, in.below(200));
  }
}

void begin_frame(Input& in, sl_client client) {
  std::array<sl_view, 4> views{};
  for (sl_view& view : views) {
    view = in.structure<sl_view>();
    view.kind = in.below(3);
    view.width = in.below(8) == 0 ? in.take<std::uint32_t>() : 64;
    view.height = 64;
    in.matrix(view.view);
    in.matrix(view.projection);
  }
  auto frame = in.structure<sl_frame>();
  frame.views = views.data();
  frame.view_count = in.below(8) == 0 ? in.below(2) * 17 : 1 + in.below(4);
  if (views[0].struct_size != sizeof(sl_view)) frame.view_count = std::min(frame.view_count, 1u);
  frame.time_s = in.number();
  if (in.below(8) == 0) {
    sl_wait_frame(client, &frame, 0.0);
  } else {
    sl_begin_frame(client, &frame);
  }
}

void edit(Input& in, sl_client client) {
  std::array<std::uint32_t, k_most> ids{};
  std::array<std::uint32_t, k_most> flags{};
  std::array<sl_box, k_most> boxes{};
  std::array<double, 16 * k_most> matrices{};
  std::array<sl_boxed_object, k_most> objects{};
  const std::size_t count = in.below(k_most + 1);
  for (std::size_t i = 0; i < count; ++i) {
    ids[i] = in.below(16) == 0 ? in.take<std::uint32_t>() : in.below(12);
    flags[i] = in.below(80);
    for (int axis = 0; axis < 3; ++axis) {
      boxes[i].min[axis] = in.number();
      boxes[i].max[axis] = in.number();
    }
    in.matrix(&matrices[16 * i]);
    objects[i].struct_size = sizeof(sl_boxed_object);
    objects[i].flags = flags[i];
    objects[i].object_box = boxes[i];
    std::memcpy(objects[i].world_from_object, &matrices[16 * i], sizeof objects[i].world_from_object);
  }
  const std::uint32_t* given = in.below(16) != 0 ? ids.data() : nullptr;
  switch (in.below(7)) {
    case 0:
      sl_move_objects(client, given, matrices.data(), count);
      return;
    case 1:
      sl_add_objects(client, objects.data(), count, ids.data());
      return;
    case 2:
      sl_remove_objects(client, given, count);
      return;
    case 3:
      sl_replace_objects(client, given, boxes.data(), count);
      return;
    case 4:
      sl_deform_objects(client, given, boxes.data(), count);
      return;
    case 5:
      sl_set_always_visible(client, given, count, static_cast<int>(in.below(2)));
      return;
    default:
      sl_show_objects(client, given, count, static_cast<int>(in.below(2)));
  }
}

void read_frame(Input& in, sl_client client) {
  const std::uint32_t view = in.below(6);
  const std::uint32_t* ids = nullptr;
  const std::uint64_t* words = nullptr;
  std::size_t count = 0, word_count = 0;
  const sl_status listed = sl_visible_ids(client, view, &ids, &count);
  if (sl_visible_bits(client, view, &words, &word_count) != listed) std::abort();
  if (listed != SL_OK) return;
  // The list, the bits and the objects one by one must say the same.
  std::size_t bits = 0;
  for (std::size_t i = 0; i < word_count; ++i)
    bits += static_cast<std::size_t>(__builtin_popcountll(words[i]));
  if (bits != count) std::abort();
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0 && ids[i] <= ids[i - 1]) std::abort();
    if (sl_object_state(client, view, ids[i]) != SL_VISIBLE) std::abort();
  }
}

void ask(Input& in, sl_client client) {
  auto why = in.structure<sl_why>();
  auto state = in.structure<sl_state>();
  auto statistics = in.structure<sl_statistics>();
  auto info = in.structure<sl_view_info>();
  std::uint64_t question = in.below(8);
  switch (in.below(7)) {
    case 0:
      sl_ask_why(client, in.below(4), in.below(16), &question);
      return;
    case 1:
      sl_take_why(client, question, &why);
      return;
    case 2:
      sl_wait_why(client, in.below(4), in.below(16), 0.0, &why);
      return;
    case 3:
      sl_get_state(client, &state);
      return;
    case 4:
      sl_get_statistics(client, &statistics);
      return;
    case 5:
      sl_get_view_info(client, in.below(4), &info);
      return;
    default:
      sl_poll(client);
  }
}

sl_client connect(Input& in, sl_scene scene) {
  std::array<sl_boxed_object, 3> objects{};
  for (sl_boxed_object& object : objects) object.struct_size = sizeof object;
  auto options = sl_options{};
  options.struct_size = sizeof options;
  options.api_version = in.below(16) != 0 ? SL_API_VERSION : in.take<std::uint32_t>();
  options.endpoint = "ipc:///nonexistent/folder/of/nobody";
  options.scene = in.below(8) != 0 ? scene : nullptr;
  options.scene_digest[0] = static_cast<std::uint8_t>(in.below(2));
  options.objects = objects.data();
  options.object_count = in.below(4);
  options.spare_count = in.below(9);
  options.matrix_layout = in.below(16) == 0 ? in.below(3) : 0;
  options.depth_range = in.below(4) == 0 ? in.below(3) : 0;
  options.reversed_depth = in.below(4) == 0 ? in.below(3) : 0;
  sl_client client = nullptr;
  const sl_status status = sl_connect(&options, &client);
  if ((status == SL_OK) != (client != nullptr)) std::abort();
  return client;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input in(data, size);
  sl_scene scene = nullptr;
  sl_client client = nullptr;
  sl_scene_create(in.below(16) == 0 ? in.below(3) : 0, &scene);
  for (int calls = 0; calls < 200 && !in.done(); ++calls) {
    switch (in.below(16)) {
      case 0:
        if (client == nullptr) client = connect(in, scene);
        break;
      case 1:
        sl_scene_digest(scene, nullptr, nullptr);
        break;
      case 2:
        sl_poll(in.take<sl_client>());
        break;  // a handle that is any number
      case 3:
      case 4:
      case 5:
      case 6:
        add_to_scene(in, scene);
        break;
      case 7:
      case 8:
        begin_frame(in, client);
        break;
      case 9:
      case 10:
        read_frame(in, client);
        break;
      case 11:
        ask(in, client);
        break;
      default:
        edit(in, client);
    }
  }
  sl_scene_destroy(scene);
  sl_wait_close(client);
  return 0;
}
