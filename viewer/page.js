// The page of scenes without layers.

import { start } from './start.js';

start();
