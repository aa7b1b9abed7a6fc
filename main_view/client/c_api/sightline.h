#ifndef SIGHTLINE_H
#define SIGHTLINE_H

/// Sightline for a renderer of your own: which objects of a heavy scene can be seen, worked out by another
/// process (control_view) and asked for here, in C. No GL, no scene files, no threads of yours.
///
///     sl_options options = {.struct_size = sizeof options, .api_version = SL_API_VERSION};
///     options.endpoint = "tcp://127.0.0.1:5571";
///     options.scene = scene;                       // described with sl_scene_...; uploaded if need be
///     sl_connect(&options, &client);
///     each frame:  sl_begin_frame(client, &frame);           // matrices and a time; never waits
///                  sl_visible_ids(client, 0, &ids, &count);  // draw these
///
/// What is not known is visible: before the scene is there, and when the daemon is late, lost or wrong, you
/// draw what you would have drawn without it. Answers are cut by the frustum of your view besides.
///
/// Rules for every call
/// - It returns SL_OK (0), a positive status that is no failure (SL_PENDING, SL_TIMEOUT), or a negative one,
///   SL_ERROR_... A call that fails changes nothing. sl_last_error has a line of text.
/// - It does not wait, unless `wait` is in its name. No exception and no signal leaves the library.
/// - Handles are checked: null, closed and made-up ones give SL_ERROR_HANDLE.
/// - Threads. [any]: from any thread at any time. [one]: one thread at a time for each handle, together with
///   no other call on it. [shared]: any number of threads at once, but together with no [one] call on that
///   handle. A call that meets another that it must not gives SL_ERROR_BUSY and does nothing: it never waits
///   for it. Different handles have nothing to do with each other.
/// - Structures begin with struct_size, which you set to sizeof; fields you do not set are to be zero. One of
///   a newer header is understood as long as the fields that this library does not know are zero. In an array
///   of structures all have the first one's size. (sl_part and sl_box, which come in long arrays, stay as
///   they are for ever.)
/// - Pointers you hand in are read during the call and not kept.
///
/// World: any units, called metres here, numbers as you have them. The front of a triangle (a, b, c) is the
/// side that (b - a) x (c - a) points to: counterclockwise in a right-handed world, clockwise in a
/// left-handed one. Matrices take column vectors (clip = projection * view * object * point) and lie in
/// memory as sl_options.matrix_layout says.

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define SL_API __attribute__((visibility("default")))
#else
#define SL_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/// Of this header. A library of the same major version and the same or a later minor one serves it.
#define SL_VERSION_MAJOR 1
#define SL_VERSION_MINOR 0
#define SL_API_VERSION ((SL_VERSION_MAJOR << 16) | SL_VERSION_MINOR)

typedef int32_t sl_status;
enum {
  SL_OK = 0,
  SL_PENDING = 1,             ///< not yet: ask again
  SL_TIMEOUT = 2,             ///< of a wait: what is known without the answer is in force
  SL_ERROR_ARGUMENT = -1,     ///< a null pointer, or a value that is none of those allowed
  SL_ERROR_HANDLE = -2,       ///< null, closed, or never given out
  SL_ERROR_STRUCT_SIZE = -3,  ///< struct_size is too small, or unknown fields are not zero
  SL_ERROR_VERSION = -4,      ///< the program was built for a newer or incompatible library
  SL_ERROR_BUSY = -5,         ///< another thread is in a call on this handle
  SL_ERROR_ORDER = -6,        ///< too early or too late, as a question before the first frame
  SL_ERROR_RANGE = -7,        ///< an id, a view or a count that does not exist
  SL_ERROR_NOT_FINITE = -8,   ///< NaN, infinite, or beyond 10^12
  SL_ERROR_MATRIX = -9,       ///< no inverse; or a view that is neither rigid, mirrored nor uniformly scaled
  SL_ERROR_FULL = -10,        ///< no spare object, or a limit is reached
  SL_ERROR_MEMORY = -11,
  SL_ERROR_MACHINE = -12,  ///< a socket or the like could not be had
  SL_ERROR_REFUSED = -13,  ///< the daemon refuses; sl_get_state says why
  SL_ERROR_INTERNAL = -14  ///< a bug in the library
};

/// Handles. Never dereferenced: numbers in a pointer's clothes.
typedef struct sl_scene_handle* sl_scene;
typedef struct sl_client_handle* sl_client;

// ---- The library --------------------------------------------------------------------------------

/// SL_API_VERSION of the library in use. [any]
SL_API uint32_t sl_version(void);
/// The same with the release, as "1.0 (sightline 0.1.0)". [any]
SL_API const char* sl_version_text(void);
/// What a status means, one line; never null. [any]
SL_API const char* sl_status_text(sl_status status);
/// One line on the last call of the calling thread that failed with this handle; with null, with any handle
/// or none. Empty when there is none. Valid until that thread's next call that fails. [any]
SL_API const char* sl_last_error(const void* handle);

// ---- Describing a scene -------------------------------------------------------------------------
// Only what hides and is hidden: triangles and where they stand. A description is finished by sl_connect or
// sl_scene_digest; nothing can be added to it afterwards (SL_ERROR_ORDER). Objects can still move, come and
// go: see below.

/// Of a scene, spare ones included. A daemon may set its own, lower limit.
#define SL_MAX_OBJECTS (1u << 22)

enum { SL_ALPHA_OPAQUE = 0, SL_ALPHA_TESTED = 1, SL_ALPHA_BLENDED = 2 };

/// How a surface is drawn. Material 0 is always there: opaque, both sides drawn.
typedef struct sl_material {
  uint32_t struct_size;
  uint32_t alpha;          ///< SL_ALPHA_...: blended hides nothing; tested hides where its texture says
  uint32_t single_sided;   ///< 1: back faces are not drawn
  float base_alpha;        ///< multiplies the texture's; 0 counts as 1
  float alpha_cutoff;      ///< tested: drawn where alpha >= this; 0 counts as 0.5
  uint32_t texture_width;  ///< tested: size of alpha_texture; 0 without one (the object then hides nothing)
  uint32_t texture_height;
  uint32_t reserved;
  const uint8_t* alpha_texture;  ///< width * height bytes, top row first; v = 0 is the top; repeats
} sl_material;

/// A run of a mesh's indices drawn with one material.
typedef struct sl_part {
  uint32_t first_index;
  uint32_t index_count;  ///< a multiple of 3
  uint32_t material;
} sl_part;

/// Triangles in the mesh's own frame.
typedef struct sl_mesh {
  uint32_t struct_size;
  uint32_t vertex_count;
  const float* positions;   ///< x, y, z each
  size_t position_stride;   ///< bytes from one to the next; 0 for 12
  const float* texcoords;   ///< u, v each, or null
  size_t texcoord_stride;   ///< bytes; 0 for 8
  const uint32_t* indices;  ///< or null: vertices in their order
  size_t index_count;       ///< a multiple of 3; ignored without indices
  const sl_part* parts;     ///< or null: all of it with `material`
  size_t part_count;
  uint32_t material;  ///< without parts
  uint32_t reserved;
} sl_mesh;

enum {
  SL_OBJECT_BLENDED = 1,         ///< hides nothing (said for all its materials at once)
  SL_OBJECT_ALPHA_TESTED = 2,    ///< has holes nobody describes: hides nothing
  SL_OBJECT_ALWAYS_VISIBLE = 4,  ///< hides, and is listed wherever its box reaches into the view
  SL_OBJECT_OCCLUDER_ONLY = 8,   ///< a proxy: hides, and no answer ever has it
  SL_OBJECT_OCCLUDEE_ONLY = 16,  ///< is hidden, hides nothing
  SL_OBJECT_NO_SHADOW = 32       ///< neither hides nor is reported in shadow views
};

/// An instance of a mesh. What is culled as a whole.
typedef struct sl_object {
  uint32_t struct_size;
  uint32_t mesh;
  uint32_t flags;  ///< SL_OBJECT_... or 0: opaque, casts a shadow
  uint32_t group;  ///< not 0: levels of detail of one thing share it. They hide nothing, and when one is seen
                   ///< the answers have the lowest id of the group
  double world_from_object[16];  ///< all zero counts as the identity
} sl_object;

/// An empty description. Layout is that of the matrices in sl_object: SL_COLUMN_MAJOR or SL_ROW_MAJOR. [any]
SL_API sl_status sl_scene_create(uint32_t matrix_layout, sl_scene* scene);
/// Forgets the description; clients made with it go on. [one]
SL_API sl_status sl_scene_destroy(sl_scene scene);
/// Each gives the new thing's number, counted from 0 (materials from 1). The number may be null. [one]
SL_API sl_status sl_scene_add_material(sl_scene scene, const sl_material* material, uint32_t* id);
SL_API sl_status sl_scene_add_mesh(sl_scene scene, const sl_mesh* mesh, uint32_t* id);
SL_API sl_status sl_scene_add_object(sl_scene scene, const sl_object* object, uint32_t* id);
/// Room for `count` objects without geometry, to be added later with sl_add_objects. The last call counts.
/// [one]
SL_API sl_status sl_scene_set_spares(sl_scene scene, uint32_t count);
/// Finishes the description, in a pass over all its bytes (about a second a gigabyte), and gives the 16 bytes
/// that name the scene everywhere: equal descriptions have equal digests. The count includes spares; either
/// may be null. [one]
SL_API sl_status sl_scene_digest(sl_scene scene, uint8_t digest[16], uint32_t* object_count);

// ---- Connecting ---------------------------------------------------------------------------------

enum { SL_COLUMN_MAJOR = 0, SL_ROW_MAJOR = 1 };
enum { SL_DEPTH_MINUS_ONE_TO_ONE = 0, SL_DEPTH_ZERO_TO_ONE = 1 };

typedef struct sl_box {
  double min[3];
  double max[3];
} sl_box;

/// An object known by a box instead of by its triangles.
typedef struct sl_boxed_object {
  uint32_t struct_size;
  uint32_t flags;  ///< SL_OBJECT_... or 0
  uint32_t group;  ///< as in sl_object
  uint32_t reserved;
  sl_box object_box;             ///< in the object's own frame; holds all that it draws
  double world_from_object[16];  ///< all zero counts as the identity
} sl_boxed_object;

typedef struct sl_options {
  uint32_t struct_size;
  uint32_t api_version;            ///< SL_API_VERSION
  const char* endpoint;            ///< "tcp://HOST:PORT" or "ipc://PATH"
  const char* client_name;         ///< for the daemon's log; null: "libsightline"
  const char* preset;              ///< null: "default". Or "avango"
  sl_scene scene;                  ///< finished by this call. Null: the daemon has the scene `scene_digest`
  uint8_t scene_digest[16];        ///< without `scene`: from sl_scene_digest, or as the daemon's log gives it
  const sl_boxed_object* objects;  ///< without `scene`: all its objects in their order, less the spares
  uint32_t object_count;           ///< without `scene`: of `objects`
  uint32_t spare_count;            ///< without `scene`
  uint32_t matrix_layout;   ///< SL_COLUMN_MAJOR (OpenGL, glm, m[12..14] is the translation) or SL_ROW_MAJOR.
                            ///< Of all matrices given to this client
  uint32_t depth_range;     ///< of clip space: SL_DEPTH_...
  uint32_t reversed_depth;  ///< 1: the near plane has the larger depth
  uint32_t reserved;
  const char* public_key;  ///< CURVE, Z85 text of 40 characters each; all three or none
  const char* secret_key;
  const char* server_public_key;
} sl_options;

enum {
  SL_STATE_CONNECTING = 1,  ///< no daemon has answered yet, or it was lost: tried again by itself
  SL_STATE_UPLOADING = 2,   ///< the daemon lacks (parts of) the scene
  SL_STATE_BUILDING = 3,    ///< the daemon has the scene and prepares for it
  SL_STATE_OPEN = 4,        ///< answers come
  SL_STATE_REFUSED = 5      ///< for good, and `text` says why. Frames go on, everything visible
};

typedef struct sl_state {
  uint32_t struct_size;
  uint32_t state;              ///< SL_STATE_...
  uint64_t upload_bytes;       ///< of the whole scene; 0 without a description
  uint64_t upload_bytes_held;  ///< that the daemon has said it has
  uint64_t lost_count;         ///< how often an open session was lost
  uint32_t object_count;       ///< spare ones included
  uint32_t free_object_count;  ///< that sl_add_objects can give out now
  uint8_t scene_digest[16];
  char text[256];  ///< one line for a person: what is refused or awaited; may be empty
} sl_state;

/// Makes a client and returns at once; connecting, uploading and reconnecting happen in the calls below, a
/// little in each. The scene may be destroyed at once, and serve any number of clients. [any], the scene
/// [one]
SL_API sl_status sl_connect(const sl_options* options, sl_client* client);
/// Ends the session. The last frames leave in the background. [one]
SL_API sl_status sl_close(sl_client client);
/// The same, and returns when the last frames have left: at most a tenth of a second. [one]
SL_API sl_status sl_wait_close(sl_client client);
/// Sends and reads what is due. sl_begin_frame does it too; for loading screens and programs that stand
/// still. Call one of the two at least four times a second, or the session may be lost (it then comes back).
/// [one]
SL_API sl_status sl_poll(sl_client client);
/// [one]
SL_API sl_status sl_get_state(sl_client client, sl_state* state);
/// Polls until the state is open (SL_OK) or refused (SL_ERROR_REFUSED), or `timeout_s` has passed
/// (SL_TIMEOUT). [one]
SL_API sl_status sl_wait_open(sl_client client, double timeout_s);

// ---- Frames -------------------------------------------------------------------------------------

#define SL_MAX_VIEWS 16
enum { SL_VIEW_IMAGE = 0, SL_VIEW_SHADOW = 1 };

/// An image that the frame draws: an eye, a mirror, a side of a cube map, a light's shadow map, another
/// window.
typedef struct sl_view {
  uint32_t struct_size;
  uint32_t kind;   ///< SL_VIEW_...
  uint32_t width;  ///< of that image, pixels; 1 to 16384
  uint32_t height;
  uint32_t control_width;  ///< of the daemon's image of it; both 0: as the daemon is set up
  uint32_t control_height;
  double view[16];  ///< camera from world: rigid, with or without a mirror, with or without uniform scale
  double projection[16];  ///< clip from camera: any with an inverse: perspective, off-axis, orthographic,
                          ///< infinite
} sl_view;

/// A view keeps its place from frame to frame: it has a history there. Views may be left out at the end.
typedef struct sl_frame {
  uint32_t struct_size;
  uint32_t view_count;  ///< 1 to SL_MAX_VIEWS
  const sl_view* views;
  double time_s;  ///< when it will be seen: seconds of a clock of yours that runs evenly and never back
} sl_frame;

/// Reads what has arrived, decides what this frame draws, and asks the daemon for what comes. Ends the frame
/// before and whatever was given out for it. Works in every state: without answers everything is visible.
/// [one]
SL_API sl_status sl_begin_frame(sl_client client, const sl_frame* frame);
/// The same for programs that have time (offline, tests): asks for exactly these views and waits until all
/// are answered. SL_TIMEOUT: the frame has begun all the same, with what is known. [one]
SL_API sl_status sl_wait_frame(sl_client client, const sl_frame* frame, double timeout_s);

/// Of an object in a view. Draw unless it is SL_HIDDEN or SL_HIDDEN_HERE; a negative value is an error: draw
/// too.
enum {
  SL_HIDDEN = 0,
  SL_VISIBLE = 1,     ///< or may be
  SL_HIDDEN_HERE = 2  ///< hidden in this view, visible in another of this frame: keep what it needs at hand
};
/// [shared]
SL_API int32_t sl_object_state(sl_client client, uint32_t view, uint32_t object);
/// All objects visible in a view, ascending. The memory is the library's and holds until the next frame
/// begins or the client is closed. [shared]
SL_API sl_status sl_visible_ids(sl_client client, uint32_t view, const uint32_t** ids, size_t* count);
/// The same as bits: object i is bit i % 64 of word i / 64; object_count bits, the rest zero. [shared]
SL_API sl_status sl_visible_bits(sl_client client, uint32_t view, const uint64_t** words, size_t* word_count);
/// Copies the ids: at most `capacity` of them, and `count` says how many there are. [shared]
SL_API sl_status sl_copy_visible_ids(sl_client client, uint32_t view, uint32_t* ids, size_t capacity,
                                     size_t* count);

typedef struct sl_view_info {
  uint32_t struct_size;
  uint32_t answered;  ///< 0: no usable answer, all that is in the view's frustum is visible
  uint32_t exact;     ///< 1: answered for this very frame (sl_wait_frame)
  uint32_t reserved;
  uint64_t visible;      ///< objects
  double answer_age_s;   ///< of the newest answer for this time or before; negative without one
  double answer_lead_s;  ///< by how much the next answer in use is ahead of this frame; negative without one
} sl_view_info;
/// How well this frame's view is known. [shared]
SL_API sl_status sl_get_view_info(sl_client client, uint32_t view, sl_view_info* info);

// ---- Objects that change ------------------------------------------------------------------------
// Each holds from the next frame on. Edits are this client's own: another with the same scene does not see
// them. All or nothing: for an id out of range, a NaN or a box inside out no object is changed.

/// New placements: one matrix of 16 an id. Call it in each frame in which they move. [one]
SL_API sl_status sl_move_objects(sl_client client, const uint32_t* ids, const double* world_from_object,
                                 size_t count);
/// Objects the scene does not have, known by their boxes: hidden when those are, and hiding nothing. Takes
/// spare ids and gives them out. SL_ERROR_FULL when there are too few: an id is free again when no answer can
/// name the object that had it. [one]
SL_API sl_status sl_add_objects(sl_client client, const sl_boxed_object* objects, size_t count,
                                uint32_t* ids);
/// Objects that no longer exist. Their ids may be given out again by sl_add_objects, not before no answer
/// under way can name them. [one]
SL_API sl_status sl_remove_objects(sl_client client, const uint32_t* ids, size_t count);
/// Other geometry from now on, known by its box (the object's own frame) as an added object is. [one]
SL_API sl_status sl_replace_objects(sl_client client, const uint32_t* ids, const sl_box* object_boxes,
                                    size_t count);
/// Objects that deform, as skinned ones: the boxes (own frame) that hold them from now on. They hide nothing.
/// Call it in each frame in which they change. [one]
SL_API sl_status sl_deform_objects(sl_client client, const uint32_t* ids, const sl_box* object_boxes,
                                   size_t count);
/// Flags objects SL_OBJECT_ALWAYS_VISIBLE from now on (always = 1), or no longer (0). The other flags are the
/// scene's and stay; an object that is to hide nothing from now on is one that deforms. [one]
SL_API sl_status sl_set_always_visible(sl_client client, const uint32_t* ids, size_t count, int always);
/// Hides (shown = 0) or shows objects again: a hidden one is not there and hides nothing. [one]
SL_API sl_status sl_show_objects(sl_client client, const uint32_t* ids, size_t count, int shown);

// ---- Why? ---------------------------------------------------------------------------------------

enum {
  // As the daemon's last look found it:
  SL_WHY_UNKNOWN = 1,          ///< nothing was answered for this view yet: visible
  SL_WHY_VISIBLE = 2,          ///< seen
  SL_WHY_OUTSIDE_TESTED = 3,   ///< outside the field that was looked at
  SL_WHY_HIDDEN = 4,           ///< by the objects in `blockers`
  SL_WHY_BELOW_THRESHOLD = 5,  ///< seen, in fewer pixels than the daemon's threshold
  SL_WHY_HELD = 6,             ///< an earlier look saw it, the last did not: the filter holds it
  SL_WHY_OPEN = 8,             ///< not seen, but it may show between samples
  SL_WHY_BOX = 9,              ///< known by its box, which may be seen
  // Not listed, by what this client knows:
  SL_WHY_ABSENT = 7,          ///< removed, hidden by sl_show_objects, or a spare
  SL_WHY_OUTSIDE = 32,        ///< its box does not reach into the view
  SL_WHY_OCCLUDER_ONLY = 33,  ///< a proxy
  SL_WHY_NO_SHADOW = 34,      ///< in a shadow view
  // Visible, by what this client knows:
  SL_WHY_ALWAYS = 48,     ///< its flag
  SL_WHY_NO_ANSWER = 49,  ///< nothing has arrived, or since a jump of the camera or a lost session
  SL_WHY_STALE = 50,      ///< the answers at hand are too old or from elsewhere
  SL_WHY_MOVED = 51,      ///< it moved, came or changed, and no answer in use looked for it there
  SL_WHY_UNCOVERED = 52,  ///< it may have been hidden by something that has moved or gone
  SL_WHY_UNTESTED = 53    ///< it reaches into a part of the view that no answer in use looked at
};

#define SL_MAX_BLOCKERS 16
typedef struct sl_why {
  uint32_t struct_size;
  uint32_t object;
  uint32_t view;
  uint32_t reason;         ///< SL_WHY_...
  int32_t state;           ///< SL_VISIBLE and so on, in the newest frame
  uint32_t daemon_asked;   ///< 1: the daemon answered, and the following are of its last look
  uint32_t pixels;         ///< in the last look
  uint32_t blocker_count;  ///< at most SL_MAX_BLOCKERS, most pixels first
  double pixels_mean;      ///< over the looks that the filter unites
  double threshold;        ///< that the mean has to exceed
  uint32_t blockers[SL_MAX_BLOCKERS];
  uint32_t blocker_pixels[SL_MAX_BLOCKERS];
  char text[256];  ///< all of it, one line for a person
} sl_why;

/// Asks the daemon about an object in a view of the newest frame. [one]
SL_API sl_status sl_ask_why(sl_client client, uint32_t view, uint32_t object, uint64_t* question);
/// The answer, once; SL_PENDING until it is there. SL_ERROR_RANGE for a question never asked or answered
/// already, and for all but the last 256. [one]
SL_API sl_status sl_take_why(sl_client client, uint64_t question, sl_why* answer);
/// Both, and waits for the answer; SL_TIMEOUT: without the daemon's part. [one]
SL_API sl_status sl_wait_why(sl_client client, uint32_t view, uint32_t object, double timeout_s,
                             sl_why* answer);

// ---- Statistics ---------------------------------------------------------------------------------

typedef struct sl_statistics {
  uint32_t struct_size;
  uint32_t daemon_drawn_objects;  ///< for the newest answer
  uint64_t frames;                ///< begun
  uint64_t frames_unanswered;     ///< in which a view had no usable answer
  uint64_t requests;              ///< sent
  uint64_t answers;               ///< received
  uint64_t bytes_sent;            ///< the scene included
  uint64_t bytes_received;
  uint64_t bad_frames;  ///< received and not understood
  uint64_t sessions_lost;
  uint64_t listed_objects;  ///< in the newest frame, all views together
  uint64_t moved_objects;   ///< told for the newest frame
  double round_trip_s;      ///< from request to answer, smoothed
  double answers_per_s;     ///< of all views together, smoothed
  double horizon_s;         ///< how far ahead of now requests look
  double begin_frame_s;     ///< what the newest sl_begin_frame took
} sl_statistics;
/// [one]
SL_API sl_status sl_get_statistics(sl_client client, sl_statistics* statistics);

#ifdef __cplusplus
}
#endif

#endif
