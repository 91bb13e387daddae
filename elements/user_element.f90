module user_element
  !! The one user-element interface. Every host (the driver, the FEAP and Abaqus adapters, a test) reaches every
  !! element through it: task; geometry and extraction; state; -> fe, ke, energies, status.
  !!
  !!     fe(i,a)     = internal force of dof i at function a           [force]
  !!     ke(i,a,k,b) = d fe(i,a) / d ue(k,b)                           [force/length]
  !!
  !! An element with a symmetric tangent fills only the blocks a >= b (each block complete); `mirror` completes it.
  !! Elements keep no state: what lasts between calls is the host's (`table`, `hist`).
  use kinds, only: wp
  use symmetric_tangent, only: mirror
  implicit none (type, external)
  private
  public :: element_type, element_geometry, element_state, element_energy, master_facet, property_record
  public :: task_prepare, task_residual, task_tangent, task_dissipation_gradient, mirror

  integer, parameter :: task_prepare = 1   !! fill geo%table with what does not change while the mesh stands
  integer, parameter :: task_residual = 2  !! fe and energies
  integer, parameter :: task_tangent = 3   !! fe, energies and ke
  integer, parameter :: task_dissipation_gradient = 4  !! of an interface element alone: fe(i,a) becomes
                                                       !! d (dissipated energy) / d ue(i,a); `hist` is left alone

  type :: property_record
    !! One line of a MATErial data set: `ELAStic NEOHook 1.0 0.3` has words ELAS, NEOH and values 1.0, 0.3.
    character(:), allocatable :: place    !! file:line, for messages
    character(4), allocatable :: words(:) !! first four letters, lower case, in order
    real(wp), allocatable :: values(:)    !! numbers, in order
  end type property_record

  type :: master_facet
    !! The other side of an interface element: the facet that a slave point is paired with.
    integer :: nen = 0                                     !! functions on the facet (0: unpaired: no force, but the
                                                           !! energy that was dissipated is told)
    integer :: degree(2) = 0                               !! Bernstein degrees
    real(wp) :: xi(2) = 0                                  !! projection of the slave point, in [0,1]; outside it on
                                                           !! the facet's smooth extension beyond the surface's edge
    logical :: held(2) = .false.                           !! xi rests on a kink of the surface in this direction
    real(wp) :: side = 1                                   !! +1 or -1: the outward normal is side*n
    real(wp) :: offset = 0                                 !! distance of the surfaces at which the gap is 0: half the
                                                           !! thicknesses of shells [length]
    real(wp), pointer, contiguous :: we(:) => null()       !! weights (nen)
    real(wp), pointer, contiguous :: ce(:, :) => null()    !! extraction operator (nen,nb)
  end type master_facet

  type :: element_geometry
    !! What an element knows of its place. Pointers into the host's arrays; nothing is copied but xe.
    integer :: ndm = 0                                     !! space dimension
    integer :: dp = 0                                      !! parametric dimension
    integer :: nen = 0                                     !! functions on the element (an interface: both sides)
    integer :: degree(3) = 0                               !! Bernstein degrees, 0 in unused directions
    real(wp), pointer, contiguous :: xe(:, :) => null()    !! reference control points (ndm,nen) [length]
    real(wp), pointer, contiguous :: we(:) => null()       !! control weights
    real(wp), pointer, contiguous :: ce(:, :) => null()    !! extraction operator (nen,nb)
    real(wp), pointer, contiguous :: table(:) => null()    !! what task_prepare wrote
    real(wp) :: xi(2) = 0                                  !! an interface element's point on its slave facet
    real(wp) :: wt = 0                                     !! its Gauss weight
    integer :: nes = 0                                     !! an interface element's slave functions (they come first)
    type(master_facet) :: master                           !! for interface elements
  end type element_geometry

  type :: element_state
    !! Values and history of one element; `hist_n` is committed, `hist` belongs to the step in progress.
    real(wp), pointer, contiguous :: ue(:, :) => null()      !! dofs now (ndf,nen)
    real(wp), pointer, contiguous :: un(:, :) => null()      !! dofs at the last converged step (ndf,nen)
    real(wp), pointer, contiguous :: hist_n(:) => null()     !! history at the last converged step
    real(wp), pointer, contiguous :: hist(:) => null()       !! history of this step, written by the element
    real(wp) :: time = 0                                     !! time at the end of the step
    real(wp) :: dt = 0                                       !! length of the step
  end type element_state

  type :: element_energy
    !! Energies of one element [force*length].
    real(wp) :: stored = 0      !! elastic
    real(wp) :: dissipated = 0  !! since the start
    real(wp) :: penalty = 0     !! in the penalty springs
    real(wp) :: gap = 0         !! an interface point's normal gap (open > 0) [length]
    real(wp) :: traction = 0    !! its normal traction (tension > 0) [force/area]
    logical :: active = .true.  !! .false.: no force and no tangent, nothing needs to be added
  end type element_energy

  type, abstract :: element_type
    !! An element formulation together with its law data; one instance serves all elements of a material.
    integer :: ndm = 0                   !! space dimension
    integer :: ndf = 0                   !! dofs per function
    integer :: dp = 0                    !! parametric dimension that it is made for, 0: any
    integer :: smoothness = 0            !! derivatives of the functions that must be continuous between elements
    logical :: symmetric = .true.        !! only blocks a >= b of ke are filled
  contains
    procedure(define_interface), deferred :: define
    procedure :: sizes => no_sizes
    procedure(evaluate_interface), deferred :: evaluate
    procedure :: begin_history => zero_history
    procedure :: is_bonded => never_bonded
    procedure :: shell_facts => no_shell_facts
    procedure :: shell_thickness => no_shell_thickness
    procedure :: output_names => no_output_names
    procedure :: output => no_output
  end type element_type

  abstract interface
    subroutine define_interface(self, ndm, properties, fault, bad_record)
      !! Read the law data of a material.
      import :: element_type, property_record
      class(element_type), intent(inout) :: self
      integer, intent(in) :: ndm                             !! space dimension of the model
      type(property_record), intent(in) :: properties(:)     !! the lines of the MATErial data set
      character(:), allocatable, intent(out) :: fault        !! fact and remedy, unallocated if all is well
      integer, intent(out) :: bad_record                     !! which line is at fault; 0: the set as a whole
    end subroutine define_interface

    pure subroutine evaluate_interface(self, task, geo, state, fe, ke, energy, status)
      !! Carry out a task. fe and ke are overwritten (ke only in task_tangent).
      import :: element_type, element_geometry, element_state, element_energy, wp
      class(element_type), intent(in) :: self
      integer, intent(in) :: task                            !! task_...
      type(element_geometry), intent(inout) :: geo
      type(element_state), intent(inout) :: state
      real(wp), contiguous, intent(inout) :: fe(:, :)        !! (ndf,nen) [force]
      real(wp), contiguous, intent(inout) :: ke(:, :, :, :)  !! (ndf,nen,ndf,nen) [force/length]
      type(element_energy), intent(out) :: energy
      integer, intent(out) :: status                         !! ok, inverted_element, ...
    end subroutine evaluate_interface
  end interface

contains

  pure subroutine no_sizes(self, geo, ntable, nhist)
    !! How much memory the host keeps for one element. Default: none; then task_prepare is not called.
    class(element_type), intent(in) :: self
    type(element_geometry), intent(in) :: geo
    integer, intent(out) :: ntable                         !! reals in geo%table
    integer, intent(out) :: nhist                          !! reals in state%hist

    ntable = 0*(self%ndf + geo%nen)
    nhist = 0
  end subroutine no_sizes

  pure subroutine zero_history(self, bonded, hist)
    !! History before the first step. Default: zero.
    class(element_type), intent(in) :: self
    logical, intent(in) :: bonded                          !! .false.: an interface point that is cracked from the start
    real(wp), intent(out) :: hist(:)

    hist = 0
    if (self%ndf < 0 .or. bonded) return  ! the default needs nothing of them
  end subroutine zero_history

  pure function never_bonded(self, hist) result(bonded)
    !! Whether an interface point with this history can still pull: it keeps its master facet beyond the surface's edge.
    !! Default: never.
    class(element_type), intent(in) :: self
    real(wp), intent(in) :: hist(:)
    logical :: bonded

    bonded = self%ndf < 0 .and. size(hist) < 0
  end function never_bonded

  pure subroutine no_shell_facts(self, rigidity, is_linear)
    !! What a joint of shells must know.
    class(element_type), intent(in) :: self
    real(wp), intent(out) :: rigidity     !! bending rigidity [force*length]; 0: no shell
    logical, intent(out) :: is_linear     !! small displacements

    rigidity = 0*self%ndf
    is_linear = .false.
  end subroutine no_shell_facts

  pure function no_shell_thickness(self) result(thickness)
    class(element_type), intent(in) :: self
    real(wp) :: thickness                 !! [length]; 0: no shell

    thickness = 0*self%ndf
  end function no_shell_thickness

  pure subroutine no_output_names(self, names)
    class(element_type), intent(in) :: self
    character(24), allocatable, intent(out) :: names(:)  !! fields that `output` gives at any point, none by default

    allocate (names(0))
    if (self%ndf < 0) return  ! the default needs nothing of self
  end subroutine no_output_names

  pure subroutine no_output(self, geo, state, xi, values, status)
    !! Fields at any points of the element, for results. Default: none.
    class(element_type), intent(in) :: self
    type(element_geometry), intent(in) :: geo
    type(element_state), intent(in) :: state
    real(wp), intent(in) :: xi(:, :)           !! points in [0,1] (dp,np)
    real(wp), intent(out) :: values(:, :)      !! (size(output_names),np)
    integer, intent(out) :: status

    values = 0
    status = 0
    if (self%ndf < 0 .or. geo%nen < 0 .or. state%dt < 0 .or. size(xi) < 0) status = 1
  end subroutine no_output
end module user_element
