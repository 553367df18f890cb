/* SPDX-License-Identifier: Apache-2.0
 * SPDX-FileCopyrightText: The pm authors
 *
 * pm_plugin.h - the C interface of pm, a photon-mapping bucket renderer. C11; the only public
 * header.
 *
 * How a host uses it
 *     load libpm_plugin.so, look up pmrGetApi, ask for PMR_ABI_VERSION, and call through the table:
 *     createContext -> createMesh / createMaterial / ... -> createScene, addInstance, setCamera,
 *     commitScene -> createRender, setSetting..., startRender -> callbacks, readPixels ->
 *     destroyRender, release...
 *
 * Conventions
 *   - Functions return a PmrStatus: PMR_OK or a negative code. lastError gives the text.
 *   - Structs hold fixed-width integers, float, double and pointers only. Their first member is
 *     their size in bytes as the caller was compiled; a larger struct than the library knows is
 *     accepted when its unknown tail is zero, a smaller one is read as if the rest were zero, so
 *     zero always means "the default". Use PMR_INIT.
 *   - Text is UTF-8, ends with 0, and numbers in it have a dot in any locale.
 *   - Arrays are copied before the call returns, unless said otherwise.
 *   - Right-handed coordinates; lengths in scene units; angles in radians; radiance in
 *     W m^-2 sr^-1 for each channel of the scene-linear rendering space; flux in W.
 *   - Rectangles are half-open pixels [x0,x1) x [y0,y1), origin top left, y down.
 *   - Transforms are 3 x 4 doubles, row-major, object to world: p' = M[:, 0:3] p + M[:, 3].
 *   - Nothing throws, exits, prints, installs a signal handler or reads an environment variable.
 *   - A handle that was released is recognised: PMR_ERROR_HANDLE, never a crash.
 *
 * Threads
 *   All functions may be called from any thread. Calls on one scene that is not committed yet, and
 *   on one render before startRender, are for one thread at a time. cancelRender, readPixels,
 *   renderState, renderStatistics and the enumerations may be called at any time, also inside a
 *   callback. Inside a callback waitRender, pollRender, destroyRender and releaseContext return
 *   PMR_ERROR_IN_CALLBACK. Callbacks of one render come one at a time: from a thread of the
 *   library (PMR_CALLBACKS_THREAD) or from inside pollRender (PMR_CALLBACKS_POLL).
 *
 * States of a render
 *   CREATED --startRender--> RUNNING --(done, failed, cancelled)--> FINISHED
 *   Settings change only in CREATED. `finished` is called exactly once and last of all callbacks.
 *   destroyRender is allowed in every state; it cancels, waits for the workers, and drops events
 *   that were not delivered yet, except `finished`, which it delivers. A render that was never
 *   started calls nothing back. A startRender that refuses (memory limit, no camera) leaves the
 *   render CREATED, so settings can be put right. cancelRender holds in any state: before
 *   startRender it makes the render end at once.
 *
 * Leaving a callback
 *   By return. A C++ exception ends at its edge and is forgotten. longjmp, and ending the thread,
 * must not be used: the library takes the callback as running for ever. That thread then gets
 *   PMR_ERROR_IN_CALLBACK from all that waits, and destroyRender of others waits for ever.
 *   docs/c_interface.md tells what is left of each callback.
 *
 * Forks
 *   In a child that the host forked, handles that were made before can be released and destroyed:
 *   PMR_OK at once; nothing is called back, and their memory ends with the child. Where a render
 *   ran, or another thread was in a call, at the fork, every other call with them returns
 *   PMR_ERROR_STATE; else they are used as ever. See docs/c_interface.md, also for exit().
 *
 * Slow hosts
 *   What waits to be delivered is bounded: progress and what comes again for one bucket are merged
 *   into the latest, and a bucketStarted is left out while an earlier event of its bucket waits.
 *   Pixels don't queue but by buckets (PMR_DELIVERY_BUCKETS), where workers wait for the host.
 */
#ifndef PM_PLUGIN_H
#define PM_PLUGIN_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(_WIN32)
#define PMR_CALL __cdecl
#define PMR_EXPORT __declspec(dllexport)
#else
#define PMR_CALL
#define PMR_EXPORT __attribute__((visibility("default")))
#endif

#define PMR_ABI_VERSION 1u

/* Zeroes a struct and sets its size: PmrMeshDesc mesh = PMR_INIT(PmrMeshDesc); */
#ifdef __cplusplus
#define PMR_INIT(Type)              \
    ([] {                           \
        Type zeroed{};              \
        zeroed.size = sizeof(Type); \
        return zeroed;              \
    }())
#else
#define PMR_INIT(Type) \
    { .size = sizeof(Type) }
#endif

/* ---- Status ------------------------------------------------------------------------------- */

typedef int32_t PmrStatus;
#define PMR_OK 0
#define PMR_ERROR_INTERNAL (-1)     /* a fault of the library */
#define PMR_ERROR_ARGUMENT (-2)     /* null pointer, bad size, value outside its range */
#define PMR_ERROR_HANDLE (-3)       /* not a live handle of the kind that is wanted */
#define PMR_ERROR_STATE (-4)        /* not allowed in this state (see the head of this file) */
#define PMR_ERROR_SCENE (-5)        /* the scene can't be rendered as it is */
#define PMR_ERROR_UNSUPPORTED (-6)  /* a kind that this version does not render yet */
#define PMR_ERROR_MEMORY (-7)       /* out of memory, or over the memory limit */
#define PMR_ERROR_IO (-8)           /* a file can't be read or written */
#define PMR_ERROR_CANCELLED (-9)    /* the render was cancelled: a result, not a fault */
#define PMR_ERROR_IN_CALLBACK (-10) /* not allowed inside a callback */
#define PMR_ERROR_TIMEOUT (-11)     /* waitRender or pollRender: nothing yet */
#define PMR_ERROR_ABI (-12)         /* this ABI version is not offered */
#define PMR_ERROR_NAME (-13)        /* no setting, parameter or layer of that name */
#define PMR_ERROR_FILE (-14)        /* a checkpoint, part or photon map is damaged, or is none */
#define PMR_ERROR_MISMATCH (-15)    /* one of these is of another picture or of other photons */

/* ---- Handles: opaque; never dereferenced by the host -------------------------------------- */

typedef struct PmrContextHandle* PmrContext;
typedef struct PmrMeshHandle* PmrMesh; /* polygon mesh, subdivision cage or sphere */
typedef struct PmrTextureHandle* PmrTexture;
typedef struct PmrMaterialHandle* PmrMaterial;
typedef struct PmrSceneHandle* PmrScene;
typedef struct PmrRenderHandle* PmrRender;
typedef struct PmrMergeHandle* PmrMerge; /* parts of one picture, put together */

/* ---- Messages ----------------------------------------------------------------------------- */

#define PMR_LEVEL_DEBUG 0
#define PMR_LEVEL_INFO 1
#define PMR_LEVEL_WARNING 2
#define PMR_LEVEL_ERROR 3

/* Codes of messages; texts may change, codes don't. Statistics count warnings by code. */
#define PMR_MESSAGE_NONE 0
#define PMR_MESSAGE_NO_LIGHT 100            /* nothing emits: the picture will be black */
#define PMR_MESSAGE_NO_PHOTONS 101          /* photons were traced and none reached a surface */
#define PMR_MESSAGE_NO_CAUSTIC_PHOTONS 102  /* specular surfaces, but an empty caustic map */
#define PMR_MESSAGE_BAD_VALUES 103          /* NaN or infinite samples were replaced by 0 */
#define PMR_MESSAGE_LOST_PHOTONS 104        /* photons ended for a numerical reason */
#define PMR_MESSAGE_DEGENERATE_GEOMETRY 105 /* zero-area or doubled triangles, unusable normals */
#define PMR_MESSAGE_TEXTURE 106             /* a texture look-up failed */
#define PMR_MESSAGE_NOT_COVERED 107         /* a class of light paths that no estimator covers */
#define PMR_MESSAGE_CHECKPOINT 108 /* a checkpoint was torn, or can't be written any more */
#define PMR_MESSAGE_PHASE 200      /* info: a phase began or ended */

/* render is null for messages of the context (creation of objects, commit). */
typedef void(PMR_CALL* PmrMessageFunction)(void* user, PmrRender render, int32_t level,
                                           int32_t code, const char* text);

typedef struct PmrContextDesc {
    uint64_t size;
    PmrMessageFunction message; /* may be null; called by the thread that calls into the context */
    void* user;
    const char* isa;  /* instruction set of the ray tracer: "best" (also null), "sse2", "sse4.2",
                         "avx", "avx2", "avx512"; the same bits on unlike machines need the same */
    uint32_t threads; /* for building scenes; 0 = all that affinity and cgroup allow */
    uint32_t reserved;
} PmrContextDesc;

/* ---- Geometry ----------------------------------------------------------------------------- */

#define PMR_NO_INDEX 0xffffffffu

/* A polygon mesh. Faces of 3 and more corners, in winding order: counter-clockwise seen from the
 * front. Normals and texture coordinates belong to corners through indices of their own. */
typedef struct PmrMeshDesc {
    uint64_t size;
    const float* positions; /* 3 x positionCount, object space, scene units */
    uint64_t positionCount;
    const uint32_t* faceSizes; /* faceCount numbers of corners; null = all triangles */
    uint64_t faceCount;
    const uint32_t* indices; /* indexCount = sum of the face sizes */
    uint64_t indexCount;
    const float* normals; /* 3 x normalCount, or null */
    uint64_t normalCount;
    const uint32_t* normalIndices; /* indexCount; PMR_NO_INDEX = the face's own; null = indices */
    const float* uvs;              /* 2 x uvCount, or null; origin bottom left */
    uint64_t uvCount;
    const uint32_t* uvIndices;     /* indexCount; PMR_NO_INDEX = none (0,0); null = indices */
    const uint32_t* materialSlots; /* faceCount slots < slotCount; null = all 0 */
    uint64_t slotCount;            /* 0 counts as 1 */
} PmrMeshDesc;

#define PMR_SCHEME_CATMULL_CLARK 0
#define PMR_SCHEME_LOOP 1
#define PMR_SCHEME_BILINEAR 2
#define PMR_BOUNDARY_EDGE_AND_CORNER 0
#define PMR_BOUNDARY_EDGE_ONLY 1
#define PMR_BOUNDARY_NONE 2
/* Where texture coordinates of a limit surface are linear in each face of the cage; elsewhere they
 * are as smooth as the surface. Charts end where faces have unlike coordinates. */
#define PMR_FACE_VARYING_BOUNDARIES 0    /* along the edges of charts */
#define PMR_FACE_VARYING_SMOOTH 1        /* nowhere: edges of charts move inwards and bend */
#define PMR_FACE_VARYING_CORNERS_ONLY 2  /* corners of charts stay, their edges bend */
#define PMR_FACE_VARYING_CORNERS_PLUS1 3 /* ... and where more than two charts meet */
#define PMR_FACE_VARYING_CORNERS_PLUS2 4 /* ... and at darts and concave corners */
#define PMR_FACE_VARYING_ALL 5           /* everywhere */

/* A subdivision cage, rendered as its limit surface. The mesh's normals are not used. */
typedef struct PmrCageDesc {
    uint64_t size;
    const PmrMeshDesc* mesh;
    int32_t scheme;
    int32_t boundary;
    const uint32_t* creases; /* 2 x creaseCount vertex indices */
    const float* creaseSharpness;
    uint64_t creaseCount;
    const uint32_t* corners; /* cornerCount vertex indices */
    const float* cornerSharpness;
    uint64_t cornerCount;
    const uint32_t* holes; /* holeCount face indices */
    uint64_t holeCount;
    uint32_t tessellationRate; /* segments along a regular face's edge, 1 to 64; 0 = 4 */
    int32_t faceVarying;       /* PMR_FACE_VARYING_* */
} PmrCageDesc;

/* An analytic sphere, one material slot. Its front is outside. Textures are latitude-longitude
 * pictures: their middle towards +z of object space, their right half towards +x, their upper edge
 * at +y. */
typedef struct PmrSphereDesc {
    uint64_t size;
    double centre[3]; /* object space */
    double radius;    /* > 0, scene units */
} PmrSphereDesc;

/* ---- Textures and materials --------------------------------------------------------------- */

#define PMR_WRAP_REPEAT 0
#define PMR_WRAP_CLAMP 1
#define PMR_WRAP_MIRROR 2
#define PMR_WRAP_BLACK 3

/* A picture by file name, its texels already in the rendering space (or data). Tiled, mip-mapped
 * .tx files are much faster than others. value = base + gain * texel. */
typedef struct PmrTextureDesc {
    uint64_t size;
    const char* fileName;
    int32_t wrapS;
    int32_t wrapT;
    float uvScale[2]; /* 0 counts as 1 */
    float uvOffset[2];
    float gain; /* 0 counts as 1 */
    float base;
    /* A checksum of the texels that the host knows, so that the file need not be read whole for the
     * hash of a render; equal texels must have equal ones. Both 0: the library makes its own. */
    uint64_t texelHash[2];
    /* In place of a picture by fileName, which then only names it: textures that each fill a square
     * of uv (UDIM). Tile 1001 + c + 10 r fills [c, c+1) x [r, r+1); of it counts the picture alone,
     * not its wrap, scale, offset, gain and base. Where there is no tile the texel is 0. */
    const PmrTexture* tiles;
    const uint32_t* tileNumbers; /* 1001 to 9999, each once */
    uint64_t tileCount;          /* 0: fileName is the picture */
} PmrTextureDesc;

#define PMR_MATERIAL_SURFACE 0    /* diffuse, plus a glossy lobe */
#define PMR_MATERIAL_MIRROR 1     /* glossy colour as reflectance */
#define PMR_MATERIAL_DIELECTRIC 2 /* boundary of a medium of index ior; front = outside */
#define PMR_MATERIAL_MIXTURE 3    /* of two others: parameters first, second, weight by name */

/* A texture multiplies the number beside it. All reflectances in [0,1]. Materials are two-sided
 * but for emission, which leaves the front. */
typedef struct PmrMaterialDesc {
    uint64_t size;
    const char* name; /* for messages; may be null */
    int32_t kind;
    int32_t fresnel;       /* perfect mirrors: 1 = Schlick's Fresnel from the glossy colour */
    float diffuse[3];      /* SURFACE: Lambertian reflectance */
    float glossy[3];       /* SURFACE: reflectance of the Phong lobe at normal incidence; MIRROR */
    float glossyExponent;  /* SURFACE: exponent of the Phong lobe, >= 0; MIRROR: 0 = perfect */
    float ior;             /* DIELECTRIC: index of refraction against vacuum, > 0; 0 = 1.5 */
    float transmission[3]; /* DIELECTRIC: tint at each transmission */
    float emission[3];     /* radiance of the front, W m^-2 sr^-1 */
    float transparency;    /* share of light that passes straight through (cut-outs); 0 = opaque */
    float reserved;
    PmrTexture diffuseTexture;
    PmrTexture glossyTexture;
    PmrTexture glossyExponentTexture;
    PmrTexture transmissionTexture;
    PmrTexture emissionTexture;
    PmrTexture opacityTexture; /* opacity = (1 - transparency) * texel */
} PmrMaterialDesc;

/* ---- Scenes ------------------------------------------------------------------------------- */

typedef struct PmrSceneDesc {
    uint64_t size;
    const char* renderingSpace; /* name, for the record; null = "linear Rec.709" */
    double rgbToXyz[9];         /* row-major; all zero = linear Rec.709 (D65) */
} PmrSceneDesc;

/* What does not see an instance; all others see it. */
#define PMR_HIDDEN_FROM_CAMERA 1u     /* it is not in the picture, but in mirrors */
#define PMR_HIDDEN_FROM_SHADOW 2u     /* it casts none: light from lights passes it */
#define PMR_HIDDEN_FROM_REFLECTION 4u /* rays that leave surfaces, and photons, pass it */

typedef struct PmrInstanceDesc {
    uint64_t size;
    PmrMesh mesh;
    const double* transforms;     /* 12 x transformCount; null = identity */
    uint64_t transformCount;      /* time samples: 1 in this version, 0 when it is null */
    const PmrMaterial* materials; /* one for each slot of the mesh */
    uint64_t materialCount;
    const char* name; /* may be null */
    uint32_t id;
    uint32_t hiddenFrom; /* PMR_HIDDEN_FROM_... added up; 0 = seen by all */
} PmrInstanceDesc;

#define PMR_LIGHT_POINT 0 /* intensity, W/sr, in all directions */
#define PMR_LIGHT_SPOT 1  /* intensity inside a cone along -z */
#define PMR_LIGHT_DIRECTIONAL \
    2 /* irradiance, W/m^2, on a surface that faces it; travels along -z */

/* Lights without area. Area lights are instances whose material emits. The transform of a spot or
 * directional light is a rotation and a translation; of a point light only the translation counts.
 *
 * A spot has its whole intensity up to coneAngle - coneFalloff from its axis and none beyond
 * coneAngle; between them it fades as 3 t^2 - 2 t^3, t going from 0 to 1 with the cosine.
 * A directional light with an angularRadius is an even disc in the sky that rays see where they
 * meet nothing; below 1e-4 rad it shines along one direction and isn't seen. */
typedef struct PmrLightDesc {
    uint64_t size;
    int32_t kind;
    uint32_t id;
    const double* transforms; /* 12 x transformCount; null = identity */
    uint64_t transformCount;
    float emission[3];
    float coneAngle;     /* spot: half angle of the whole cone, radians, in (0, pi] */
    float coneFalloff;   /* spot: angle inside it over which the light fades, in [0, coneAngle] */
    float angularRadius; /* directional: half angle of the disc, radians, in [0, pi/2] */
    const char* name;
} PmrLightDesc;

/* Light from infinitely far all around, seen by rays that meet nothing; it has no coverage. Set
 * again, the last counts. Of the texture the middle lies towards -z, the right half towards +x, the
 * upper edge towards +y. */
typedef struct PmrEnvironmentDesc {
    uint64_t size;
    float radiance[3]; /* W m^-2 sr^-1, times the texture where there is one */
    float reserved;
    PmrTexture texture;       /* latitude-longitude, may be null */
    const double* transforms; /* 12 x transformCount, a rotation; null = identity */
    uint64_t transformCount;
} PmrEnvironmentDesc;

#define PMR_CAMERA_PERSPECTIVE 0
#define PMR_CAMERA_ORTHOGRAPHIC 1
#define PMR_CAMERA_PANORAMA 2

/* Looks along -z of its transform, +y up, +x right. */
typedef struct PmrCameraDesc {
    uint64_t size;
    int32_t kind;
    int32_t reserved;
    const double* transforms; /* 12 x transformCount */
    uint64_t transformCount;
    double fieldOfView; /* perspective: vertical, radians, in (0, pi) */
    double height;      /* orthographic: scene units */
    double lensRadius;  /* depth of field; 0 = pinhole */
    double focusDistance;
    double pixelAspect; /* 0 = 1 */
} PmrCameraDesc;

/* ---- Parameters by name --------------------------------------------------------------------- */

/* What has parameters. The structs above are presets of them: each of their members that is a
 * number, a text or a texture is a parameter of the same name (of transforms the one time sample).
 * What comes after ABI version 1's structs comes as a parameter only. */
#define PMR_OBJECT_MATERIAL 0
#define PMR_OBJECT_LIGHT 1
#define PMR_OBJECT_ENVIRONMENT 2
#define PMR_OBJECT_CAMERA 3
#define PMR_OBJECT_INSTANCE 4
#define PMR_OBJECT_SPHERE 5 /* the first of the shapes that createShape makes */

#define PMR_PARAMETER_NUMBER 0
#define PMR_PARAMETER_INTEGER 1
#define PMR_PARAMETER_CHOICE 2 /* one of `choices`, by its name or by its place there */
#define PMR_PARAMETER_TEXT 3
#define PMR_PARAMETER_TEXTURE 4
#define PMR_PARAMETER_OBJECTS 5 /* handles: by the struct only */

/* What a host needs to make a panel or a manual. Texts belong to the library and live as long. */
typedef struct PmrParameterInfo {
    uint64_t size;
    const char* name;
    const char* unit;        /* "" = none */
    const char* defaultText; /* as setParameter takes it as a text */
    const char* choices;     /* CHOICE: separated by commas; else "" */
    const char* help;        /* one line */
    double minimum;          /* NUMBER and INTEGER, of each number */
    double maximum;          /* infinity: none, but finite */
    int32_t type;
    uint32_t count;          /* of numbers */
    int32_t excludesMinimum; /* 1: above it */
    int32_t excludesMaximum; /* 1: below it */
    int32_t changesPixels;   /* 1 when the picture depends on it */
    int32_t reserved;
} PmrParameterInfo;

/* One parameter of one object, and its value: numbers, a text ("0.5 0.5 1", "mirror") or, of a
 * parameter of type TEXTURE, a texture, null for none. */
typedef struct PmrParameterDesc {
    uint64_t size;
    int32_t object;       /* PMR_OBJECT_* */
    uint32_t index;       /* LIGHT, INSTANCE: which of the scene's, as they were added, from 0 */
    PmrMaterial material; /* MATERIAL; else null */
    PmrScene scene;       /* LIGHT to INSTANCE; else null */
    const char* name;
    const double* numbers;
    uint64_t numberCount;
    const char* text;
    PmrTexture texture;
} PmrParameterDesc;

/* ---- Settings ------------------------------------------------------------------------------ */

#define PMR_SETTING_INTEGER 0
#define PMR_SETTING_NUMBER 1
#define PMR_SETTING_CHOICE 2 /* one of `choices` */
#define PMR_SETTING_TEXT 3

/* What a host needs to make a panel or a manual. Texts belong to the library and live as long. */
typedef struct PmrSettingInfo {
    uint64_t size;
    const char* name;
    const char* unit;        /* "" = none */
    const char* defaultText; /* as setSettingText takes it */
    const char* choices;     /* CHOICE: separated by commas; else "" */
    const char* help;        /* one line */
    const char* cost;        /* one line: what it costs in time or memory */
    double minimum;          /* INTEGER and NUMBER, both ends allowed */
    double maximum;
    int32_t type;
    int32_t changesPixels; /* 1 when the picture depends on it */
} PmrSettingInfo;

/* ---- Layers (AOVs) ------------------------------------------------------------------------- */

#define PMR_LAYER_COLOUR 0
#define PMR_LAYER_DATA 1

typedef struct PmrLayerInfo {
    uint64_t size;
    const char* name;     /* "beauty", "direct", "albedo", "N", ... */
    const char* channels; /* full channel names for files, separated by commas: "N.X,N.Y,N.Z" */
    const char* help;
    uint32_t channelCount;
    int32_t kind;      /* PMR_LAYER_COLOUR or PMR_LAYER_DATA */
    int32_t isDefault; /* rendered without being asked for */
    int32_t reserved;
} PmrLayerInfo;

/* ---- Renders ------------------------------------------------------------------------------- */

typedef struct PmrRectangle {
    int32_t x0, y0, x1, y1;
} PmrRectangle;

typedef struct PmrBucketInfo {
    uint64_t size;
    PmrRectangle rectangle;
    uint32_t bucketIndex; /* its place in the bucket order (of correlated: in that of hilbert) */
    uint32_t bucketCount; /* of one pass */
    uint32_t passIndex;   /* the pass that just came, from 0 */
    uint32_t passCount;   /* at most: an error target or a time limit may end a render earlier */
    uint64_t sampleCount; /* camera samples in this bucket and pass */
    double seconds;       /* wall time, drawn to rendered, of all its passes that follow */
    uint32_t timedPasses; /* those that this render made: none in bucketStarted and for what came
                             from a checkpoint */
    uint32_t reserved;
    uint64_t cacheMisses; /* of bounded caches, for all these passes: what had to be made or read */
    uint64_t cacheBytes;  /* its bytes; textures are not in it */
} PmrBucketInfo;

#define PMR_CALLBACKS_THREAD 0
#define PMR_CALLBACKS_POLL 1

#define PMR_RENDER_CREATED 0
#define PMR_RENDER_RUNNING 1
#define PMR_RENDER_FINISHED 2

/* What becomes of the pixels; follows from the setting delivery, the memory limit and what the
 * render needs, never from time. The picture is the same.
 *   FRAME: all of them are kept until destroyRender, and can be read at any time.
 *   BUCKETS: a bucket is rendered with all its passes; its bucketStarted and bucketFinished come
 *   once, in the bucket order. readPixels works inside bucketFinished only, from any thread until
 *   that returns, and knows that bucket's pixels: others are 0. Then they are forgotten. Some
 *   buckets (a few for each thread) may wait for the host; when it takes none the workers wait,
 *   and so a host that is slow slows the render down. In the poll mode waitRender is refused while
 *   the render runs (PMR_ERROR_STATE). What was finished before a cancel is still delivered.
 *   sampleCount is that of all passes, passIndex that of the last. */
#define PMR_DELIVERY_FRAME 0
#define PMR_DELIVERY_BUCKETS 1

/* Why a render ended. */
#define PMR_STOP_NONE 0         /* it has not */
#define PMR_STOP_PASSES 1       /* all passes are done */
#define PMR_STOP_ERROR_TARGET 2 /* the estimated relMSE is within the setting errorTarget */
#define PMR_STOP_TIME_LIMIT 3   /* another pass would not fit into timeLimitSeconds */
#define PMR_STOP_CANCELLED 4
#define PMR_STOP_FAILED 5

typedef void(PMR_CALL* PmrProgressFunction)(void* user, PmrRender render, double fraction,
                                            double remainingSeconds); /* NaN: not known yet */
typedef void(PMR_CALL* PmrBucketFunction)(void* user, PmrRender render,
                                          const PmrBucketInfo* bucket);
typedef void(PMR_CALL* PmrFinishedFunction)(void* user, PmrRender render, PmrStatus status);

typedef struct PmrRenderDesc {
    uint64_t size;
    int32_t callbackMode;
    int32_t reserved;
    void* user;
    PmrMessageFunction message; /* each may be null */
    PmrProgressFunction progress;
    PmrBucketFunction bucketStarted;
    PmrBucketFunction bucketFinished;
    PmrFinishedFunction finished;
} PmrRenderDesc;

/* ---- The table ------------------------------------------------------------------------------ */

/* Functions are only ever appended. Texts that functions write to a buffer: `needed`, when not
 * null, receives the bytes wanted, the closing 0 included; a buffer that is too small gets what
 * fits, ended by 0, and PMR_ERROR_ARGUMENT is returned; buffer may be null to ask for the size.
 * While a render runs its statistics may grow between two calls: ask again with the new size. */
typedef struct PmrApi {
    uint64_t size;
    uint32_t abiVersion;
    uint32_t reserved;

    const char*(PMR_CALL* versionText)(void); /* "0.1.0 (embree 3.13.5, ...)" */
    const char*(PMR_CALL* statusText)(PmrStatus status);

    /* Enumerations; need no context. */
    uint32_t(PMR_CALL* settingCount)(void);
    PmrStatus(PMR_CALL* settingInfo)(uint32_t index, PmrSettingInfo* info);
    uint32_t(PMR_CALL* layerCount)(void);
    PmrStatus(PMR_CALL* layerInfo)(uint32_t index, PmrLayerInfo* info);

    /* Contexts. Releasing one that still has scenes or renders is fine: it lives until they end. */
    PmrStatus(PMR_CALL* createContext)(const PmrContextDesc* desc, PmrContext* context);
    PmrStatus(PMR_CALL* releaseContext)(PmrContext context);
    /* Why the last call of this thread failed that returned a status, this one's own not counted;
     * empty after PMR_OK. context may be null, as after a createContext that failed. */
    PmrStatus(PMR_CALL* lastError)(PmrContext context, char* buffer, uint64_t capacity,
                                   uint64_t* needed);

    /* Reusable objects; each starts with one reference, which the host owns. */
    PmrStatus(PMR_CALL* createMesh)(PmrContext context, const PmrMeshDesc* desc, PmrMesh* mesh);
    PmrStatus(PMR_CALL* createCage)(PmrContext context, const PmrCageDesc* desc, PmrMesh* mesh);
    PmrStatus(PMR_CALL* createSphere)(PmrContext context, const PmrSphereDesc* desc, PmrMesh* mesh);
    PmrStatus(PMR_CALL* retainMesh)(PmrMesh mesh);
    PmrStatus(PMR_CALL* releaseMesh)(PmrMesh mesh);
    PmrStatus(PMR_CALL* createTexture)(PmrContext context, const PmrTextureDesc* desc,
                                       PmrTexture* texture);
    PmrStatus(PMR_CALL* retainTexture)(PmrTexture texture);
    PmrStatus(PMR_CALL* releaseTexture)(PmrTexture texture);
    PmrStatus(PMR_CALL* createMaterial)(PmrContext context, const PmrMaterialDesc* desc,
                                        PmrMaterial* material);
    PmrStatus(PMR_CALL* retainMaterial)(PmrMaterial material);
    PmrStatus(PMR_CALL* releaseMaterial)(PmrMaterial material);

    /* Scenes: built, committed, then immutable. An edit makes a new scene from the same handles. */
    PmrStatus(PMR_CALL* createScene)(PmrContext context, const PmrSceneDesc* desc, PmrScene* scene);
    PmrStatus(PMR_CALL* retainScene)(PmrScene scene);
    PmrStatus(PMR_CALL* releaseScene)(PmrScene scene);
    PmrStatus(PMR_CALL* addInstance)(PmrScene scene, const PmrInstanceDesc* desc);
    PmrStatus(PMR_CALL* addLight)(PmrScene scene, const PmrLightDesc* desc);
    PmrStatus(PMR_CALL* setEnvironment)(PmrScene scene, const PmrEnvironmentDesc* desc);
    PmrStatus(PMR_CALL* setCamera)(PmrScene scene, const PmrCameraDesc* desc);
    /* Checks, tessellates and builds the ray-tracing structure. */
    PmrStatus(PMR_CALL* commitScene)(PmrScene scene);
    /* bounds: min x, y, z, max x, y, z in world space; the scene must be committed. */
    PmrStatus(PMR_CALL* sceneBounds)(PmrScene scene, double bounds[6]);

    /* Renders. */
    PmrStatus(PMR_CALL* createRender)(PmrScene scene, const PmrRenderDesc* desc, PmrRender* render);
    PmrStatus(PMR_CALL* setSettingInteger)(PmrRender render, const char* name, int64_t value);
    PmrStatus(PMR_CALL* setSettingNumber)(PmrRender render, const char* name, double value);
    PmrStatus(PMR_CALL* setSettingText)(PmrRender render, const char* name, const char* value);
    PmrStatus(PMR_CALL* settingText)(PmrRender render, const char* name, char* buffer,
                                     uint64_t capacity, uint64_t* needed);
    /* What the scene needs, one reason a line; allowed before startRender. PMR_ERROR_ARGUMENT for
     * settings that startRender would refuse of a run of buckets. */
    PmrStatus(PMR_CALL* explainRender)(PmrRender render, char* buffer, uint64_t capacity,
                                       uint64_t* needed);
    PmrStatus(PMR_CALL* startRender)(PmrRender render);
    /* Delivers callbacks (PMR_CALLBACKS_POLL) for up to timeoutSeconds; returns PMR_OK once
     * something was delivered, PMR_ERROR_TIMEOUT when nothing came, PMR_ERROR_STATE when
     * `finished` has been delivered before. A negative timeout waits for ever. */
    PmrStatus(PMR_CALL* pollRender)(PmrRender render, double timeoutSeconds);
    /* Waits for the end (PMR_CALLBACKS_THREAD: until `finished` has returned). Returns the status
     * of the render, or PMR_ERROR_TIMEOUT. A negative timeout waits for ever. In the poll mode
     * it waits for the workers only and delivers nothing. */
    PmrStatus(PMR_CALL* waitRender)(PmrRender render, double timeoutSeconds);
    PmrStatus(PMR_CALL* cancelRender)(PmrRender render); /* any thread, any time, any number */
    PmrStatus(PMR_CALL* renderState)(PmrRender render, int32_t* state, PmrStatus* status);
    PmrStatus(PMR_CALL* destroyRender)(PmrRender render);

    /* The layers of this render, in the order of the pixels. */
    PmrStatus(PMR_CALL* renderLayerCount)(PmrRender render, uint32_t* count);
    PmrStatus(PMR_CALL* renderLayerInfo)(PmrRender render, uint32_t index, PmrLayerInfo* info);
    /* Copies a rectangle of a layer, all its channels as floats side by side. stderr, samples and
     * aalevel need not be among the render's layers: every render has them. Strides in bytes; the
     * row stride may be negative (destination is where the rectangle's top row goes); 0 means side
     * by side without a gap. Pixels that
     * are not rendered yet, or outside the frame, are 0. */
    PmrStatus(PMR_CALL* readPixels)(PmrRender render, const PmrRectangle* rectangle,
                                    const char* layer, float* destination, int64_t pixelStrideBytes,
                                    int64_t rowStrideBytes);
    /* JSON, "schema": "pm-stats/1" (the library's part); at any time after startRender. */
    PmrStatus(PMR_CALL* renderStatistics)(PmrRender render, char* buffer, uint64_t capacity,
                                          uint64_t* needed);

    /* PMR_STOP_*; at any time, also inside `finished`. The table's size tells whether it is
     * there: it came after the first version. */
    PmrStatus(PMR_CALL* renderStopReason)(PmrRender render, int32_t* reason);

    /* Pieces of a picture: docs/farm.md. A render makes a part, keeps a checkpoint and goes on from
     * one by its settings buckets, part, checkpoint, resume and hostIdentity; by photonMap it reads
     * photons in place of tracing them. With photonsOnly it traces them into that file and makes no
     * picture: no bucket events, no layers, PMR_ERROR_NAME from readPixels. What follows puts
     * parts together without the scene; one call on a merge at a time. These functions came after
     * renderStopReason. */
    PmrStatus(PMR_CALL* createMerge)(PmrContext context, PmrMerge* merge);
    /* Reads and checks a part; the first one says which picture it is. PMR_ERROR_IO: it can't be
     * read. PMR_ERROR_FILE: it is damaged. PMR_ERROR_MISMATCH: it is of another picture; lastError
     * says what differs. A part that is refused adds nothing, and others may still be added. */
    PmrStatus(PMR_CALL* addPart)(PmrMerge merge, const char* file);
    /* The buckets that no part has, as the setting buckets takes them: "A:B", one range a line;
     * empty when the picture is whole. As all that follows PMR_ERROR_STATE before the first part.
     */
    PmrStatus(PMR_CALL* mergeMissing)(PmrMerge merge, char* buffer, uint64_t capacity,
                                      uint64_t* needed);
    /* As for a render. Statistics are those that are known of a picture: no times, no counters. */
    PmrStatus(PMR_CALL* mergeSettingText)(PmrMerge merge, const char* name, char* buffer,
                                          uint64_t capacity, uint64_t* needed);
    PmrStatus(PMR_CALL* mergeLayerCount)(PmrMerge merge, uint32_t* count);
    PmrStatus(PMR_CALL* mergeLayerInfo)(PmrMerge merge, uint32_t index, PmrLayerInfo* info);
    PmrStatus(PMR_CALL* readMergedPixels)(PmrMerge merge, const PmrRectangle* rectangle,
                                          const char* layer, float* destination,
                                          int64_t pixelStrideBytes, int64_t rowStrideBytes);
    PmrStatus(PMR_CALL* mergeStatistics)(PmrMerge merge, char* buffer, uint64_t capacity,
                                         uint64_t* needed);
    PmrStatus(PMR_CALL* releaseMerge)(PmrMerge merge);

    /* PMR_DELIVERY_*: of a render that was started, or as it would be with the settings as they
     * are; so a host that sets delivery to "fit" learns before startRender whether it has to take
     * pixels inside bucketFinished. Errors: PMR_ERROR_ARGUMENT as startRender gives it. It came
     * after releaseMerge. */
    PmrStatus(PMR_CALL* renderDelivery)(PmrRender render, int32_t* delivery);

    /* With 1, createMesh, createCage, createTexture and commitScene of this context, and what plans
     * a render of its scenes (explainRender, renderDelivery, startRender), whether they run now or
     * are called later, return PMR_ERROR_CANCELLED soon and make nothing, until it is called with
     * 0; a scene then stays open and may be committed again, a render may be started. What a
     * library has in work by then may go on for a while on a thread of its own; the next such call
     * of the process waits for it, and so does its exit(). Any thread, any time, any number. Came
     * after renderDelivery.
     */
    PmrStatus(PMR_CALL* cancelBuilds)(PmrContext context, int32_t on);

    /* Enumerations; need no context. object: PMR_OBJECT_*; 0 for one that is not there. They came
     * after cancelBuilds. */
    uint32_t(PMR_CALL* parameterCount)(int32_t object);
    PmrStatus(PMR_CALL* parameterInfo)(int32_t object, uint32_t index, PmrParameterInfo* info);
    /* Sets one parameter of a material that no scene uses yet, or of a light, the environment, the
     * camera or an instance of a scene that is not committed. PMR_ERROR_NAME: there is none of that
     * name, lastError has those that there are. PMR_ERROR_ARGUMENT: outside its range, which
     * lastError has, or together with the object's others not allowed. PMR_ERROR_STATE: used or
     * committed. The object stays as it was then. */
    PmrStatus(PMR_CALL* setParameter)(const PmrParameterDesc* desc);
    /* A shape of a kind that has parameters, one material slot; what is not among them has its
     * default. object: PMR_OBJECT_SPHERE or one of those that follow; of each parameter it must be
     * the same, material and scene null. Errors: those of setParameter. Came after setParameter. */
    PmrStatus(PMR_CALL* createShape)(PmrContext context, int32_t object,
                                     const PmrParameterDesc* const* parameters, uint32_t count,
                                     PmrMesh* mesh);
    /* What it is called: "material", "sphere". Needs no context; null for one that is not there. */
    const char*(PMR_CALL* objectName)(int32_t object);

    /* Bytes that this process may still take beside what it holds, for what a host does on its own:
     * of limitGib as the setting memoryLimitGib has it, 0 and all that it refuses standing for what
     * cgroups and the machine allow; and of its address space. Needs no context; reads small files.
     * 0 where memory ran out. Any thread. Came after objectName. */
    uint64_t(PMR_CALL* memoryLeft)(double limitGib);
} PmrApi;

/* The one symbol. Returns PMR_ERROR_ABI when that version is not offered. Any thread. */
PMR_EXPORT PmrStatus PMR_CALL pmrGetApi(uint32_t abiVersion, const PmrApi** api);
typedef PmrStatus(PMR_CALL* PmrGetApiFunction)(uint32_t abiVersion, const PmrApi** api);

#ifdef __cplusplus
}
#endif

#endif /* PM_PLUGIN_H */
