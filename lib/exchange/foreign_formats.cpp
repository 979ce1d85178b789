#include "lib/exchange/foreign_formats.h"

#include "formats/interchange/bcd_raw.h"
#include "formats/interchange/noisebase.h"
#include "formats/interchange/npz_export.h"
#include "formats/interchange/npz_import.h"
#include "formats/interchange/sbmc.h"
#include "lib/exchange/bcd_statistics.h"
#include "lib/exchange/deep_exr.h"
#include "lib/exchange/exr_folder_export.h"
#include "lib/exchange/exr_folder_import.h"
#include "lib/exchange/oidn_set.h"

namespace spool::exchange {

const std::vector<interchange::ImportFormat>& import_formats() {
  static const std::vector<interchange::ImportFormat> list = {
      interchange::npz_format(), exr_folder_format(),        deep_exr_format(),
      interchange::bcd_format(), interchange::sbmc_format(), interchange::noisebase_format()};
  return list;
}

const std::vector<interchange::ExportFormat>& export_formats() {
  static const std::vector<interchange::ExportFormat> list = {
      interchange::npz_target(), exr_folder_target(),     deep_exr_target(),
      interchange::bcd_target(), bcd_statistics_target(), oidn_target()};
  return list;
}

}  // namespace spool::exchange
