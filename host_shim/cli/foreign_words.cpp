// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/cli/foreign_words.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "host_shim/values/letter_case.h"

namespace pm::host {
namespace {

struct Entry {
    std::string_view words;  // in lower case without - and _, blanks between and around them
    std::string_view answer;
};

// Words of the command lines and render settings of the renderers that the header names, by their
// manuals; those that several have are first.
constexpr auto kEntries = std::to_array<Entry>({
    {" width height w h resolution res imagesize imgwidth imgheight outputsize xres yres "
     "xresolution "
     "yresolution resx resy resolutionx resolutiony renderwidth renderheight dimensions filmwidth "
     "filmheight filmsize ",
     "--size WxH is meant"},
    {" scale percentage resolutionpercentage resolutionscale ", "--size WxH is meant, in pixels"},
    {" spp samples sample samplesperpixel numsamples nsamples pixelsamples samplecount maxsamples "
     "minsamples aasamples antialiasing antialias cameraaasamples haltspp iterations numiterations "
     "supersampling subpixelsamples raysperpixel ",
     "samples of a pixel are --passes N, and in each of them --aa N|MIN:MAX"},
    {" quality preset ", "--error-target RELMSE is meant, or --passes N"},
    {" noise noisethreshold noiselevel adaptivethreshold haltthreshold convergence variance "
     "adaptivesampling aaadaptive maxerror ",
     "--error-target RELMSE is meant, or of single pixels --aa-threshold T"},
    {" time maxtime timeout halttime rendertime seconds duration timebudget minutes ",
     "--time-limit SECONDS is meant"},
    {" depth maxdepth bounces maxbounces raydepth pathdepth pathlength maxpathlength "
     "diffusebounces "
     "glossybounces transmissionbounces transparentmaxbounces gidiffusedepth gispeculardepth "
     "raydepthlimit maxtracelevel rrdepth russianroulette recursion ",
     "pm has none: light is followed as long as it carries something; how far away things are is "
     "--aov Z"},
    {" aperture fstop fnumber lens lensradius aperturesize aperturefstop depthoffield dof "
     "focusdistance focaldistance focus bokeh blades apertureblades circleofconfusion ",
     "pm has none: its camera is a pinhole, and all of the picture is sharp"},
    {" focallength sensor sensorwidth sensorheight filmback hfov fovx fovaxis horizontalfov xfov ",
     "--fov DEG is meant, the vertical angle of view"},
    {" fieldofview viewangle angle yfov vfov fovy fovdeg ", "--fov DEG is meant, vertical"},
    {" motionblur motion shutter shutteropen shutterclose shutterspeed shutterstart shutterend "
     "deformationblur ",
     "pm has none: a picture is of one moment"},
    {" denoise denoiser oidn optixdenoiser usedenoising denoising ",
     "pm has none; --passes N or --error-target RELMSE renders longer, and --aov albedo,N writes "
     "what other denoisers want"},
    {" clamp clampindirect clampdirect maxradiance fireflies firefly fireflyfilter "
     "maxcomponentvalue aasampleclamp ",
     "pm has none: no light is cut off; --passes N or --aa MIN:MAX lessens noise"},
    {" gamma tonemap tonemapping tonemapper viewtransform outputgamma srgb filmic displaygamma ",
     "--display NAME and --view NAME are meant, see --list views; how bright it is is --exposure"},
    {" brightness ev stops iso gain filmexposure ", "--exposure STOPS|auto is meant"},
    {" hdri hdr envmap env ibl skybox sky dome domelight background backgroundimage world skydome "
     "environmentmap environmentlight lightprobe infinite ",
     "--environment FILE is meant, or --sun AZIMUTH,ELEVATION"},
    {" sunlight sundirection daylight sunsky sunelevation sunazimuth sunposition ",
     "--sun AZIMUTH,ELEVATION is meant"},
    {" envrotation rotation hdrirotation skyrotation ", "--environment-rotation DEG is meant"},
    {" envstrength hdristrength skystrength envintensity ", "--environment-strength S is meant"},
    {" light lights headlight addlight defaultlight ",
     "--camera-light on is meant; other lights stand in SCENE.pm.json"},
    {" ambient ao ambientocclusion ",
     "pm has none: light from all around is --environment FILE or --sun AZIMUTH,ELEVATION"},
    {" from origin camerapos cameraposition campos position pos location cameralocation viewpoint ",
     "--eye x,y,z is meant"},
    {" to target lookat cameratarget interest direction viewdirection camdir cameradirection ",
     "--look-at x,y,z is meant, a place"},
    {" upvector cameraup zup yup axisup upaxis vup ",
     "--up x,y,z is meant, as --up 0,0,1 where z is up"},
    {" ortho orthographic projection panorama panoramic fisheye equirectangular spherical stereo "
     "vr "
     "cameratype ",
     "pm has none: its camera is perspective"},
    {" aspect aspectratio pixelaspect ", "pm has none: pixels are square, see --size WxH"},
    {" fps framerate video movie movieformat animation animate anim renderanim mp4 ",
     "pm has none: it renders frames, --frames A-B, for a program that makes a film of them"},
    {" start end framestart frameend startframe endframe firstframe lastframe framerange fstart "
     "fend framejump step framestep ",
     "--frames A-BxS is meant"},
    {" renderframe framenumber ", "--frame N is meant"},
    {" gpu cuda optix hip metal oneapi opencl device devices cyclesdevice usegpu gpuid listdevices "
     "rtx wavefront ",
     "pm has none: it renders on processors, as many as --threads N says"},
    {" nthreads numthreads cores cpus ncores cpu threadcount numcores workers processes jobs "
     "thread "
     "workthreads parallel ",
     "--threads N is meant"},
    {" out outfile outputfile outputpath outputimage renderoutput image imagefile save dest "
     "destination write filename imagefilename ",
     "-o FILE is meant"},
    {" input infile inputfile scene scenefile file obj mesh model load import ",
     "the scene has no option before it: pm_host SCENE"},
    {" format fileformat renderformat imageformat outputformat filetype png exr jpg ",
     "the ending of -o FILE says it, as .exr or .png"},
    {" half bitdepth colordepth colourdepth exrdepth depthbits bits ",
     "--exr-half is meant; an EXR has 32 bits otherwise"},
    {" alpha transparent transparentbackground filmtransparent outputalpha ",
     "pm has none: pictures that can, as .exr and .png, always have the coverage as alpha"},
    {" tilesize tiles tile tilewidth tileheight tilex tiley bucket bucketscanning blocksize ",
     "--bucket-size N is meant"},
    {" tileorder bucketorder renderorder blockorder ", "--bucket-order NAME is meant"},
    {" region window cropwindow border renderregion roi rect subregion startrow startcolumn endrow "
     "endcolumn pixelbounds ",
     "--crop x0,y0,x1,y1 is meant, in pixels"},
    {" pixel debugpixel ", "--only-pixel X,Y is meant"},
    {" memory maxmemory memlimit ram mem ", "--memory-limit GIB is meant"},
    {" randomseed rngseed noiseseed animateseed ", "--seed N|frame is meant"},
    {" pixelfilter rfilter filterwidth filtersize reconstructionfilter filtertype ",
     "--filter box|gaussian is meant"},
    {" sampler samplingpattern samplegenerator sobol halton ",
     "pm has none: it chooses its random numbers by --seed N alone"},
    {" renderer engine mode method algorithm type renderengine rendermode lightingmethod "
     "pathtracing "
     "pathtracer bdpt mlt vcm sppm ",
     "--integrator photon|path is meant"},
    {" photoncount numphotons nphotons photonspass photonsperiteration causticphotons "
     "globalphotons photonspp photonnumber ",
     "--photons N is meant, of each pass"},
    {" radius photonradius gatherradius searchradius lookupradius initialradius lookupsize "
     "nearestphotons gatherphotons ",
     "pm has none: the radius is that of so many photons, --estimate-photons K"},
    {" finalgather fg gather gathersamples finalgathersamples irradiancecache gi indirect "
     "globalillumination radiosity ",
     "that is always on; its rays are --gather-rays N|auto"},
    {" caustics usecaustics causticreflective causticrefractive ",
     "that is always on where a scene has them, see --explain"},
    {" subsurf subdivision subdivs subdiv subdivide tessellation ",
     "--subdivide all|tagged|none is meant"},
    {" config settings options settingsfile ini configfile ",
     "pm has none: all settings are options; a script can keep them"},
    {" overwrite force yes ", "pm has none: pictures of the same name are replaced"},
    {" silent nostdin quietmode noprogress ", "-q is meant, or --progress none"},
    {" loglevel verbosity debug logfile logging ", "-v is meant, or --log FILE"},
    {" preview interactive ipr livepreview viewer gui ",
     "pm has none; --size of a smaller picture with --passes 1 is soon done, and --report "
     "FILE.html "
     "is a page to look at"},
    {" continue restart resumerender ", "--resume is meant, with --checkpoint FILE"},
    {" stat statistics statsfile json ", "--stats FILE is meant"},
    {" aovs passesaov channels layers renderpasses outputs normals albedo ",
     "--aov NAME[,NAME] is meant, see --list aovs"},
    {" colorspace colourspace colormanagement workingspace renderspace ",
     "--rendering-space NAME is meant, see --list spaces"},
    {" materials mtl materialfile mtllib ",
     "pm has none: the .obj names its .mtl; --search-path DIR says where else it may lie"},
    {" texturepath textures texturedir searchdir includepath include path assetpath ",
     "--search-path DIR is meant"},
    {" cachedir cache ", "--texture-cache DIR is meant"},
});

// Of one letter with a sign, as typed: POV-Ray's and what several programs share.
constexpr auto kLetters = std::to_array<Entry>({
    {" +w +h -W -w -r ", "--size WxH is meant"},
    {" +o ", "-o FILE is meant"},
    {" +i -i ", "the scene has no option before it: pm_host SCENE"},
    {" +a +am +r -s -n ", "samples of a pixel are --passes N, and in each of them --aa N|MIN:MAX"},
    {" +q ", "--error-target RELMSE is meant, or --passes N"},
    {" -t -j +wt ", "--threads N is meant"},
    {" +kfi +kff -a ", "--frames A-B is meant"},
    {" -f ", "--frame N is meant"},
    {" +sc +ec +sr +er -c ", "--crop x0,y0,x1,y1 is meant, in pixels"},
    {" +c ", "--resume is meant, with --checkpoint FILE"},
    {" -V ", "--version is meant"},
});

std::string_view answerOf(auto& entries, std::string_view word) {
    const std::string padded = " " + std::string(word) + " ";
    const auto found = std::ranges::find_if(
        entries, [&](const Entry& entry) { return entry.words.find(padded) != entry.words.npos; });
    return found == entries.end() ? std::string_view() : found->answer;
}

// "+W640" and "-t8" without their value; POV-Ray's letters in any case.
std::string withoutNumber(std::string_view word) {
    const auto last = word.find_last_not_of("0123456789.");
    const std::string_view letters = word.substr(0, last + 1);
    return word.starts_with('+') ? lowerCase(letters) : std::string(letters);
}

}  // namespace

std::string_view aboutForeignWord(std::string_view word) {
    const bool isPov = word.starts_with('+');
    const bool isLetter = isPov || (word.starts_with('-') && withoutNumber(word).size() == 2);
    if (isLetter) {
        const std::string letters = withoutNumber(word);
        // POV-Ray's names of files follow their letter at once.
        const bool hasName = letters.starts_with("+i") || letters.starts_with("+o");
        return answerOf(kLetters, hasName ? std::string_view(letters).substr(0, 2) : letters);
    }
    std::string plain = lowerCase(word);
    std::erase_if(plain, [](char c) { return c == '-' || c == '_'; });
    return answerOf(kEntries, plain);
}

}  // namespace pm::host
