#include "tools/command_line/image_verbs.h"

namespace spool::tools {

void add_picture(Program& program) {
  CLI::App& verb = *program.app.add_subcommand(
      "picture", "an EXR as a PNG to look at: tone-mapped, or false colour with its bar");
  PictureOptions& options = program.picture;
  verb.add_option("IMAGE", options.image,
                  "an OpenEXR image, or the folder of spool evaluate, whose results are all drawn")
      ->required();
  CLI::Option* exposure = within(
      verb.add_option("--exposure", options.exposure,
                      "EV: values times 2^EV, then sRGB (the log-average luminance becomes middle "
                      "grey)"),
      kExposure);
  CLI::Option* like =
      verb.add_option("--like", options.like, "take the automatic exposure from this image")
          ->excludes(exposure);
  CLI::Option* colour = verb.add_flag("--false-colour", options.false_colour,
                                      "one channel, or the luminance, as colours with a bar");
  colour->excludes(exposure)->excludes(like);
  verb.add_option("--channel", options.channel, "of --false-colour: its name")->needs(colour);
  verb.add_option("--range", options.range, "of --false-colour: LOW,HIGH (all values)")
      ->needs(colour);
  verb.add_flag("--log", options.log, "of --false-colour: a logarithmic scale")->needs(colour);
  group_options(verb, "False colour", {"--false-colour", "--channel", "--range", "--log"});
  repeatable(verb.add_option("--flip-map", options.flip_maps,
                             "of a folder of results: make the map of this one, NAME/flip.exr, and "
                             "draw nothing; several times"));
  add_layer(verb, options.layer, "", "of IMAGE");
  verb.add_option("-o,--output", options.output, "the picture of an image to write, NAME.png");
  add_common(verb, program.common, false, true);
  verb.footer(
      "For eyes, not for measuring. Pixels that are not finite are magenta.\n"
      "Examples:\n"
      "  spool picture image.exr -o image.png\n"
      "  spool picture image.exr --like reference.exr -o image.png\n"
      "  spool picture density.exr --false-colour --log --range 1,64 -o density.png\n"
      "  spool picture results");
  runs(verb, program, run_picture, program.picture);
}

void add_show(Program& program) {
  CLI::App& verb = *program.app.add_subcommand(
      "show", "images beside each other as one HTML file: flip, split, zoom, error and FLIP maps");
  ShowOptions& options = program.show;
  verb.add_option(
          "IMAGES", options.images,
          "EXR files of one size, R, G, B or one channel, scene-linear; NAME=FILE.exr names "
          "one")
      ->required();
  verb.add_option("--reference", options.reference,
                  "an EXR: adds errors, error maps and FLIP maps against it");
  repeatable(verb.add_option(
      "--crop", options.crops,
      "X,Y,WIDTH,HEIGHT in pixels: enlarged below the images; may be given again (where "
      "images differ most)"));
  within(verb.add_option(
             "--exposure", options.settings.exposure,
             "EV of all images at first (middle grey, of the reference or the first image)"),
         kExposure);
  within(
      verb.add_option(
          "--max-image-mb", options.settings.most_mb,
          "megabytes of images in the page; larger ones are shrunk, and the page names them (40)"),
      kShownMb);
  verb.add_option("--title", options.settings.title, "heading of the page");
  add_output(verb, options.output,
             "the HTML file, NAME.html; it needs no network and no other file");
  add_common(verb, program.common, false, true);
  verb.footer(
      "The numbers are those of spool metrics. Needs Python 3 with numpy.\n"
      "Examples:\n"
      "  spool show before.exr after.exr --reference reference.exr -o page.html\n"
      "  spool show ours=a/image.exr theirs=b/image.exr --crop 30,20,40,30 -o page.html");
  runs(verb, program, run_show, program.show);
}

}  // namespace spool::tools
