module run_results
  !! What a run leaves: the rows of history.csv that the deck asks for, fields at the asked steps, restart states.
  use kinds, only: wp
  use model_data, only: model_type
  use model_sets, only: nodes_of_set
  use equilibrium, only: equilibrium_type
  use step_control, only: step_control_type
  use path_control, only: path_control_type
  use history_writer, only: history_writer_type
  use field_output, only: field_output_type
  use element_fields, only: evaluate_element_fields
  use interface_fields, only: evaluate_interface_fields
  use result_frame, only: result_field_type, named_text_type
  use result_folder, only: result_folder_type
  use restart_state, only: write_restart
  use point_histories, only: point_displacement
  implicit none (type, external)
  private
  public :: run_results_type, column_label

  integer, parameter :: label_length = 64

  type :: run_results_type
    type(result_folder_type) :: folder
    type(history_writer_type) :: history
    type(field_output_type) :: fields
    character(:), allocatable :: identity          !! deck text and parameters
    character(:), allocatable :: fault             !! what could not be written, unallocated when all is well
    integer :: last_field_step = -1
    logical :: time_is_step = .false.              !! fields are stamped with the step: load time may go back
    logical, private :: fields_begun = .false.
    type(named_text_type), allocatable, private :: provenance(:)
  contains
    procedure :: begin
    procedure :: resume
    procedure :: add_row
    procedure :: write_fields
    procedure :: write_state
    procedure :: wants_fields
    procedure, private :: note
  end type run_results_type

contains

  subroutine begin(self, model, provenance)
    !! New files in a folder that has begun.
    class(run_results_type), intent(inout) :: self
    type(model_type), intent(in) :: model
    type(named_text_type), intent(in) :: provenance(:)

    self%provenance = provenance
    call self%history%begin(self%folder%file('history.csv'), labels(model))
    if (self%history%failed) call self%note(self%history%message)
  end subroutine begin

  subroutine resume(self, model, provenance, step, time)
    !! Go on after a step of which the state was read.
    class(run_results_type), intent(inout) :: self
    type(model_type), intent(in) :: model
    type(named_text_type), intent(in) :: provenance(:)
    integer, intent(in) :: step
    real(wp), intent(in) :: time

    self%provenance = provenance
    call self%history%resume(self%folder%file('history.csv'), labels(model), merge(-1, step, step == 0))
    if (self%history%failed) call self%note(self%history%message)
    if (.not. model%outputs%fields) return
    call self%fields%resume(self%folder, model%mesh, model%x, model%w, model%material_of, model%body_of, &
      has_interface(model), provenance, step, time)
    if (self%fields%failed) call self%note(self%fields%message)
    self%fields_begun = .true.
    if (self%fields%has_step(step)) self%last_field_step = step
  end subroutine resume

  pure function has_interface(model) result(yes)
    type(model_type), intent(in) :: model
    logical :: yes

    yes = allocated(model%interfaces)
    if (yes) yes = size(model%interfaces) > 0
  end function has_interface

  pure function column_label(label, kind, component) result(name)
    !! `<label>_rx`, `<label>_uy`, ...
    character(*), intent(in) :: label, kind
    integer, intent(in) :: component
    character(label_length) :: name
    name = label//'_'//kind//char(iachar('x') + component - 1)
  end function column_label

  pure function end_column(label, kind) result(name)
    !! `<label>_m`, `<label>_rot`.
    character(*), intent(in) :: label, kind
    character(label_length) :: name
    name = label//kind
  end function end_column

  function labels(model) result(names)
    !! The columns of history.csv that the deck asks for, in its order.
    type(model_type), intent(in) :: model
    character(label_length), allocatable :: names(:)
    integer :: h, i

    allocate (names(0))
    if (.not. allocated(model%histories)) return
    do h = 1, size(model%histories)
      associate (request => model%histories(h))
        if (request%reaction) names = [names, (column_label(request%label, 'r', i), i=1, model%ndm)]
        if (request%displacement) names = [names, (column_label(request%label, 'u', i), i=1, model%ndm)]
        if (request%moment) names = [names, end_column(request%label, '_m')]
        if (request%rotation) names = [names, end_column(request%label, '_rot')]
        if (request%work) names = [names, [character(label_length) :: 'work']]
        if (request%elastic) names = [names, [character(label_length) :: 'elastic']]
        if (request%dissipated) names = [names, [character(label_length) :: 'dissipated']]
        if (request%penalty) names = [names, [character(label_length) :: 'penalty_energy']]
        if (request%penetration) names = [names, [character(label_length) :: 'penetration']]
        if (request%balance) names = [names, [character(label_length) :: 'energy_error']]
      end associate
    end do
  end function labels

  subroutine add_row(self, model, eq, step, iterations, cutbacks)
    class(run_results_type), intent(inout) :: self
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(in) :: eq
    integer, intent(in) :: step, iterations, cutbacks
    real(wp), allocatable :: values(:), supports(:, :)
    integer, allocatable :: nodes(:)
    integer :: h, i

    allocate (values(0))
    if (allocated(model%histories)) then
      allocate (supports, mold=eq%f_n)
      call eq%system%map%support_forces(eq%f_n, supports)
      do h = 1, size(model%histories)
        associate (request => model%histories(h))
          if (allocated(request%nodes)) then
            values = [values, point_displacement(request, eq%un, model%ndm)]
          else if (request%reaction .or. request%displacement) then
            nodes = nodes_of_set(model, request%set)
            if (request%reaction) values = [values, (sum(supports(i, nodes)), i=1, model%ndm)]
            if (request%displacement) values = [values, (sum(eq%un(i, nodes))/max(size(nodes), 1), i=1, model%ndm)]
          end if
          if (request%moment) values = [values, end_moment(model, eq, request%end_face)]
          if (request%rotation) values = [values, eq%un(1, model%end_faces(request%end_face)%rotation)]
          if (request%work) values = [values, eq%energies_n%work]
          if (request%elastic) values = [values, eq%energies_n%elastic]
          if (request%dissipated) values = [values, eq%energies_n%dissipated]
          if (request%penalty) values = [values, eq%energies_n%penalty]
          if (request%penetration) values = [values, eq%energies_n%penetration]
          if (request%balance) values = [values, eq%energies_n%balance_error()]
        end associate
      end do
    end if
    call self%history%add_row(step, eq%time_n, iterations, cutbacks, eq%active, values)
    if (self%history%failed) call self%note(self%history%message)
  end subroutine add_row

  pure function end_moment(model, eq, number) result(moment)
    !! The moment that the support of a prescribed rotation, or the load, applies to an end face.
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(in) :: eq
    integer, intent(in) :: number            !! index into model%end_faces
    real(wp) :: moment

    associate (column => model%end_faces(number)%rotation)
      if (model%fixed(1, column)) then
        moment = eq%f_n(1, column)
      else
        moment = eq%fext_n(1, column)
      end if
    end associate
  end function end_moment

  pure function wants_fields(self, model, step, time) result(yes)
    !! Whether the deck asks for fields at a step (the last one of a run is written anyway).
    class(run_results_type), intent(in) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: step
    real(wp), intent(in) :: time
    logical :: yes

    yes = .false.
    if (.not. model%outputs%fields .or. step == self%last_field_step) return
    if (model%outputs%every > 0) yes = mod(step, model%outputs%every) == 0
    if (allocated(model%outputs%steps)) yes = yes .or. any(model%outputs%steps == step)
    if (allocated(model%outputs%times)) yes = yes .or. &
      any(abs(model%outputs%times - time) <= 1.0e-9_wp*max(abs(time), 1.0e-30_wp))
  end function wants_fields

  subroutine write_fields(self, model, eq, step)
    !! Fields of the committed state.
    class(run_results_type), intent(inout) :: self
    type(model_type), intent(inout) :: model
    type(equilibrium_type), intent(in) :: eq
    integer, intent(in) :: step
    type(result_field_type), allocatable :: fields(:), point_fields(:)
    real(wp), allocatable :: points(:, :)
    integer :: failures

    if (allocated(self%fault)) return
    if (.not. self%fields_begun) then
      call self%fields%begin(self%folder, model%mesh, model%x, model%w, model%material_of, model%body_of, &
        has_interface(model), self%provenance)
      self%fields_begun = .true.
    end if
    call evaluate_element_fields(model, self%fields%cells, eq%un, eq%un, eq%time_n, 0.0_wp, eq%bulk, fields, failures)
    call evaluate_interface_fields(model, eq%interfaces, eq%un, points, point_fields)
    call self%fields%write(self%folder, model%mesh, model%w, step, &
      merge(real(step, wp), eq%time_n, self%time_is_step), eq%un(:, 1:model%nn), fields, points, point_fields)
    if (self%fields%failed) call self%note(self%fields%message)
    self%last_field_step = step
  end subroutine write_fields

  subroutine write_state(self, eq, control, path, step)
    !! The restart state.
    class(run_results_type), intent(inout) :: self
    type(equilibrium_type), intent(inout) :: eq
    type(step_control_type), intent(in) :: control
    type(path_control_type), intent(in) :: path
    integer, intent(in) :: step
    character(:), allocatable :: message

    if (allocated(self%fault)) return
    call write_restart(self%folder%file('restart.h5'), self%identity, step, eq, control, path, message)
    if (allocated(message)) call self%note(message)
  end subroutine write_state

  subroutine note(self, message)
    class(run_results_type), intent(inout) :: self
    character(*), intent(in) :: message
    if (.not. allocated(self%fault)) self%fault = message
  end subroutine note
end module run_results
