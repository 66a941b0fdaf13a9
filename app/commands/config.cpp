// sparsha config schema|keys: what a configuration may say, for editors and for people.
#include <memory>
#include <string>

#include "app/commands/commands.h"
#include "app/keys/json_schema.h"
#include "app/keys/reference.h"
#include "app/terminal/terminal.h"

namespace sparsha::app {

void add_config(Command app, const CommonOptions& common, Run& run) {
  Command command = app.add_subcommand("config", "What a configuration may say, for people and for editors");
  command.requires_subcommand();
  Command schema =
      command.add_subcommand("schema", "The JSON schema by which editors complete and check a configuration");
  schema.footer("The first line of a configuration names it: # yaml-language-server: $schema=FILE");
  schema.callback([&run] {
    run = [] {
      print(json_schema_text());
      return 0;
    };
  });
  auto block = std::make_shared<std::string>();
  Command keys = command.add_subcommand("keys", "Every key with its values, unit and default, one a line");
  keys.add_option("block", *block, "a block alone, such as grid or audio.regions; absent: all");
  keys.callback([block, &common, &run] {
    run = [block, &common] {
      print(common.json ? reference_json(*block) : reference_text(*block));
      return 0;
    };
  });
}

}  // namespace sparsha::app
