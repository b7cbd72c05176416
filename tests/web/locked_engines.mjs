// Checks that every package in a lock file runs on the Node.js of Debian 12: node locked_engines.mjs LOCK...

import { readFileSync } from 'node:fs';
import semver from 'semver';

const debians_node = '18.20.4';

for (const lock of process.argv.slice(2)) {
  for (const [path, { version, engines }] of Object.entries(JSON.parse(readFileSync(lock)).packages)) {
    if (engines?.node && !semver.satisfies(debians_node, engines.node)) {
      console.log(`${lock}: ${path} ${version} needs Node.js ${engines.node}, and Debian 12 has ${debians_node}`);
      process.exitCode = 1;
    }
  }
}
