import * as page from './page.js';
import * as ride from './ride.js';
import * as three from './three.js';

/** Everything the page can be asked to do. */
export const tasks = { ...page, ...ride, ...three };

Object.assign(window, { tasks });
