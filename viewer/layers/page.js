// The page of scenes with layers.

import { start } from '../start.js';
import { SceneLayers } from './scene_layers.js';
import { TechniqueSheet } from './techniques.js';
import { cameraOnPath } from './terrain_path.js';

start({ SceneLayers, TechniqueSheet, cameraOnPath });
